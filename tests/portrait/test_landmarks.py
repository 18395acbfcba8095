import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget import FaceModel
from sketchwidget.portrait import FaceLandmarks
from sketchwidget.portrait.landmarks import EYES, nearest_on_contour


@pytest.fixture(scope="module")
def points():
    return FaceModel.load().face().landmarks[:, :2] * (1, -1) + 150


def test_the_nearest_point_of_a_square():
    square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    near = nearest_on_contour(np.array([[1.0, -1], [3, 3], [1.2, 1], [-1, 1.5]]), square)
    assert np.allclose(near, [[1, 0], [2, 2], [2, 1], [0, 1.5]])


def test_eye_landmarks_snap_to_the_lids_and_others_stay(points):
    turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    middle = points[EYES["left"]].mean(axis=0)
    lids = middle + 12 * np.stack([1.5 * np.cos(turn), np.sin(turn)], axis=1)
    snapped = FaceLandmarks(points, {"left": lids}).snapped()
    ellipse = (((snapped.points[EYES["left"]] - middle) / (18, 12)) ** 2).sum(axis=1)
    assert np.allclose(ellipse, 1, atol=0.02)
    others = np.delete(np.arange(68), np.arange(42, 48))
    assert np.array_equal(snapped.points[others], points[others])


@given(st.floats(0.2, 5), st.floats(-300, 300))
def test_moving_scales_the_irises_too(scale, shift):
    points = np.random.default_rng(0).uniform(0, 100, (68, 2))
    marks = FaceLandmarks(points, irises={"right": np.array([10.0, 20, 3])})
    moved = marks.moved(lambda p: p * scale + shift)
    assert np.allclose(moved.irises["right"], [10 * scale + shift, 20 * scale + shift, 3 * scale])
    assert np.isclose(moved.eye_distance, scale * marks.eye_distance)


@pytest.mark.parametrize(
    ("given_points", "told"),
    [
        (np.zeros((5, 2)), r"given shape \(5, 2\)"),
        (np.zeros((68, 2)), "one line or point"),
        (np.full((68, 2), np.nan), r"given \[nan, nan\] as landmark 0"),
        ("nobody", "nobody"),
    ],
)
def test_landmarks_are_68_points(given_points, told):
    with pytest.raises(ValueError, match=told):
        FaceLandmarks(given_points)
