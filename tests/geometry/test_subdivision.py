"""Catmull-Clark subdivision."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget.geometry.subdivision import catmull_clark

CUBE = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
CORNERS = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], dtype=float)
GRID = np.array([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]])


def test_cube_by_hand():
    """A corner moves to (F + 2 R) / 3 = (1/3 + 2 / 6) / 3 = 2/9 of the way in; an edge's point to 1/8 beside it."""
    matrix, quads, edges = catmull_clark(CUBE, 8)
    fine = matrix @ CORNERS
    assert fine.shape == (8 + 12 + 6, 3)
    np.testing.assert_allclose(fine[0], [2 / 9] * 3, atol=1e-6)
    edge = 8 + np.flatnonzero((edges == [0, 1]).all(axis=1))[0]
    np.testing.assert_allclose(fine[edge], [0.5, 1 / 8, 1 / 8], atol=1e-6)
    assert trimesh.Trimesh(fine, np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]), process=False).is_watertight


def test_boundary_follows_the_cubic_b_spline():
    matrix, _, _ = catmull_clark(GRID, 9)
    np.testing.assert_allclose(matrix[1].toarray()[0], [1 / 8, 3 / 4, 1 / 8, 0, 0, 0, 0, 0, 0], atol=1e-7)


@given(st.integers(0, 2**32 - 1))
def test_affine_maps_commute_with_subdivision(seed):
    random = np.random.default_rng(seed)
    linear, shift = random.normal(size=(3, 3)), random.normal(size=3)
    matrix, _, _ = catmull_clark(CUBE, 8)
    np.testing.assert_allclose(matrix @ (CORNERS @ linear.T + shift), (matrix @ CORNERS) @ linear.T + shift, atol=1e-5)


@pytest.mark.parametrize(("quads", "count"), [(CUBE[:, :3], 8), (CUBE, 9), (CUBE, 7)])
def test_bad_topology_is_refused(quads, count):
    with pytest.raises(ValueError):
        catmull_clark(quads, count)
