import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget.geometry.rasterise import rasterise


def test_a_right_triangle_by_hand():
    corners = np.array([[0.0, 0], [4, 0], [0, 4]])
    triangle, weights = rasterise(corners, np.array([[0, 1, 2]]), (4, 5))
    drawn = triangle == 0
    expected = [[1, 1, 1, 1, 0], [1, 1, 1, 0, 0], [1, 1, 0, 0, 0], [1, 0, 0, 0, 0]]
    assert np.array_equal(drawn, np.array(expected, dtype=bool))
    assert (triangle[~drawn] == -1).all()
    assert np.allclose(weights[0, 0], [0.75, 0.125, 0.125])


def test_the_nearer_triangle_is_seen_whatever_the_order():
    corners = np.array([[0.0, 0], [8, 0], [0, 8], [0, 0], [8, 0], [0, 8]])
    depth = np.array([0.0, 0, 0, 1, 1, 1])
    for faces in ([[0, 1, 2], [3, 4, 5]], [[3, 4, 5], [0, 1, 2]]):
        triangle, _ = rasterise(corners, np.array(faces), (8, 8), depth)
        assert set(np.unique(triangle)) == {-1, faces.index([3, 4, 5])}


@given(st.integers(0, 10_000))
def test_weights_give_back_the_middles_of_the_pixels(seed):
    random = np.random.default_rng(seed)
    corners = random.uniform(-5, 25, (6, 2))
    faces = np.array([[0, 1, 2], [3, 5, 4]])
    triangle, weights = rasterise(corners, faces, (16, 20), random.normal(size=6))
    row, column = np.nonzero(triangle >= 0)
    found = (corners[faces[triangle[row, column]]] * weights[row, column][..., None]).sum(axis=1)
    assert np.allclose(found, np.stack([column, row], axis=1) + 0.5, atol=1e-4)


def test_two_halves_of_a_square_leave_no_gap():
    corners = np.array([[1.0, 1], [9, 1], [9, 9], [1, 9]])
    triangle, _ = rasterise(corners, np.array([[0, 1, 2], [0, 2, 3]]), (10, 10))
    assert (triangle[1:9, 1:9] >= 0).all() and (triangle >= 0).sum() == 64


def test_triangles_without_area_and_outside_are_not_drawn():
    corners = np.array([[1.0, 1], [5, 5], [9, 9], [100, 100], [110, 100], [100, 110]])
    triangle, _ = rasterise(corners, np.array([[0, 1, 2], [3, 4, 5]]), (10, 10))
    assert (triangle == -1).all()
