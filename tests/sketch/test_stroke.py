import numpy as np
import pytest

from sketchwidget.sketch import arc_length, as_stroke
from sketchwidget.sketch.stroke import MAX_GIVEN_POINTS, MAX_POINTS


def test_a_stroke_is_a_frozen_copy():
    given = np.array([[0.1, 0.2], [0.3, 0.4]], dtype=np.float32)
    stroke = as_stroke(given)
    given[0] = 9
    assert stroke.dtype == np.float32
    np.testing.assert_allclose(stroke, [[0.1, 0.2], [0.3, 0.4]], rtol=1e-6)
    with pytest.raises(ValueError, match="read-only"):
        stroke[0] = 0


@pytest.mark.parametrize("points", [[[0.5, 0.5]], [[0.5, 0.5]] * 7, np.full((MAX_GIVEN_POINTS, 2), 0.5)])
def test_points_in_one_place_are_a_dot(points):
    np.testing.assert_array_equal(as_stroke(points), [[0.5, 0.5]])


def test_a_long_stroke_is_bounded_by_arc_length():
    x = np.linspace(0, 1, 100_000) ** 3
    stroke = as_stroke(np.stack([x, 0 * x], axis=1))
    assert len(stroke) == MAX_POINTS
    np.testing.assert_allclose(np.diff(arc_length(stroke)), 1 / (MAX_POINTS - 1), rtol=1e-3)


def test_integers_are_points():
    np.testing.assert_array_equal(as_stroke([[0, 0], [1, 2]]), [[0, 0], [1, 2]])


@pytest.mark.parametrize(
    ("points", "complaint"),
    [
        ([], r"given shape \(0,\)"),
        (np.empty((0, 2)), r"given shape \(0, 2\)"),
        ([0.1, 0.2], r"given shape \(2,\)"),
        ([[0.1, 0.2, 0.3]], r"given shape \(1, 3\)"),
        ([[0.1, 0.2], [0.3]], "rows of different lengths"),
        ([["0.1", "0.2"]], "given <U3 values"),
        ([[True, False]], "given bool values"),
        ([[1j, 0]], "given complex128 values"),
        ([[10**400, 0]], "given object values"),
        (None, "given object values"),
        ({"x": 1}, "given object values"),
        ("stroke", "given <U6 values"),
        ([[0.1, 0.2], [np.nan, 0.2]], "as point 1"),
        ([[np.inf, 0.2]], "as point 0"),
        ([[1e300, 0.2]], "as point 0"),
        ([[0.5, 2.001]], r"within \[-1, 2\]"),
        ([[0.5, 0.5], [-1.001, 0.5]], "as point 1"),
        (np.zeros((MAX_GIVEN_POINTS + 1, 2)), r"given shape \(1000001, 2\)"),
    ],
)
def test_what_is_no_stroke_is_an_error_that_says_so(points, complaint):
    with pytest.raises(ValueError, match=complaint):
        as_stroke(points)
