import numpy as np
import pytest
from scipy import sparse

from sketchwidget.geometry.banded import BandedCholesky


def grid(side):
    line = sparse.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(side, side))
    return sparse.kronsum(line, line, format="csr")


def test_a_system_by_hand():
    factor = BandedCholesky(sparse.csr_matrix([[2.0, 0.0, 1.0], [0.0, 3.0, 0.0], [1.0, 0.0, 2.0]]))
    np.testing.assert_allclose(factor.solve(np.array([[3.0], [6.0], [3.0]])), [[1.0], [2.0], [1.0]])


def test_the_order_of_rows_does_not_matter():
    matrix, wanted = grid(12), np.random.default_rng(0).normal(size=(144, 2))
    shuffled = np.random.default_rng(1).permutation(144)
    for order in (np.arange(144), shuffled):
        mixed = matrix[order][:, order]
        np.testing.assert_allclose(BandedCholesky(mixed).solve(mixed @ wanted), wanted)


def test_what_is_not_positive_definite_is_refused():
    with pytest.raises(np.linalg.LinAlgError):
        BandedCholesky(grid(3) - 5 * sparse.identity(9))
