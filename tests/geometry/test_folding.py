"""Triangles that an edit turned over."""

import numpy as np

from sketchwidget.geometry.folding import turned_over

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def test_a_corner_that_goes_over_the_diagonal_folds_one_triangle():
    for corner, folded in (([0.1, 0.9, 0], 0), ([0.4, 0.6, 5], 0), ([0.6, 0.4, 0], 1), ([0.6, 0.4, 5], 1)):
        after = SQUARE.copy()
        after[3] = corner
        assert turned_over(SQUARE, after, TRIANGLES) == folded


def test_what_faced_the_back_or_hardly_the_front_is_no_fold():
    assert turned_over(SQUARE, SQUARE * [-1, 1, 1], TRIANGLES) == 2
    assert turned_over(SQUARE * [-1, 1, 1], SQUARE, TRIANGLES) == 0
    steep = SQUARE @ np.array([[1.0, 0, 5], [0, 1, 0], [0, 0, 1]])
    assert turned_over(steep, SQUARE * [-1, 1, 1], TRIANGLES) == 0
