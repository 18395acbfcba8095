import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from sketchwidget.sketch import arc_length, lengths, resample, resample_each

polylines = hnp.arrays(np.float64, st.tuples(st.integers(1, 20), st.just(2)), elements=st.floats(-1, 2, width=32))


def test_arc_length_of_a_right_angle():
    np.testing.assert_allclose(arc_length(np.array([[0, 0], [3, 0], [3, 4]])), [0, 3, 7])


def test_arc_length_in_space():
    np.testing.assert_allclose(arc_length(np.array([[0, 0, 0], [1, 2, 2], [1, 2, 7]])), [0, 3, 8])


def test_resampling_a_right_angle():
    np.testing.assert_allclose(
        resample(np.array([[0, 0], [2, 0], [2, 2]]), 5), [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2]]
    )


def test_a_dot_stays_a_dot():
    dot = np.array([[0.5, 0.25]])
    np.testing.assert_array_equal(resample(dot, 3), np.repeat(dot, 3, axis=0))


@given(polylines, st.integers(2, 50))
def test_resampling_keeps_the_ends_and_never_lengthens(points, n):
    resampled = resample(points, n)
    assert resampled.shape == (n, 2)
    np.testing.assert_array_equal(resampled[[0, -1]], points[[0, -1]].astype(np.float32))
    assert arc_length(resampled)[-1] <= arc_length(points)[-1] + 1e-5


@given(polylines)
def test_fine_resampling_keeps_the_length(points):
    # Each corner is cut by at most one step, 1/2000 of the length.
    length = arc_length(points)[-1]
    assert abs(arc_length(resample(points, 2001))[-1] - length) <= len(points) * length / 2000 + 1e-4


@given(st.lists(polylines, max_size=5), st.integers(1, 20))
def test_each_of_many_is_resampled_as_if_alone(lines, n):
    together = resample_each(lines, n)
    assert together.shape == (len(lines), n, 2)
    for points, line in zip(together, lines, strict=True):
        along = arc_length(line)
        wanted = np.linspace(0, along[-1], n)
        alone = np.stack([np.interp(wanted, along, line[:, k]) for k in (0, 1)], axis=1)
        np.testing.assert_allclose(points, alone, atol=1e-6)


@given(st.lists(polylines, max_size=5))
def test_each_of_many_is_as_long_as_if_alone(lines):
    np.testing.assert_allclose(lengths(lines), [arc_length(line)[-1] for line in lines], atol=1e-9)


def test_at_least_one_point_is_asked_for():
    with pytest.raises(ValueError, match="at least 1"):
        resample(np.zeros((2, 2)), 0)
