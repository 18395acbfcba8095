"""Similarity alignment."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sketchwidget.geometry.alignment import similarity


@given(st.integers(0, 2**32 - 1))
def test_a_known_similarity_comes_back(seed):
    random = np.random.default_rng(seed)
    points = random.normal(size=(20, 3))
    rotation = Rotation.random(random_state=random).as_matrix()
    scale, shift = random.uniform(0.2, 5), random.normal(size=3)
    found = similarity(points, scale * points @ rotation.T + shift)
    assert found[0] == pytest.approx(scale)
    np.testing.assert_allclose(found[1], rotation, atol=1e-9)
    np.testing.assert_allclose(found[2], shift, atol=1e-8)


def test_a_mirror_image_is_not_matched_by_a_reflection():
    points = np.random.default_rng(0).normal(size=(20, 3))
    assert np.linalg.det(similarity(points, points * [-1, 1, 1])[1]) == pytest.approx(1)


def test_arrays_of_two_shapes_are_refused():
    with pytest.raises(ValueError, match=r"\(4, 3\) and \(5, 3\)"):
        similarity(np.zeros((4, 3)), np.zeros((5, 3)))
