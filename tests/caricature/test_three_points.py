import numpy as np
import pytest

from sketchwidget.caricature import Camera, fit
from sketchwidget.caricature.three_points import landmarks_from

POINTS = [[120.0, 200.0], [300.0, 190.0], [215.0, 400.0]]


def test_the_three_are_met_and_the_rest_is_a_face_that_can_be_fitted(model):
    landmarks = landmarks_from(POINTS, model)
    np.testing.assert_allclose(landmarks[[36, 45, 8]], POINTS, atol=1e-6)
    assert landmarks[30, 1] > landmarks[27, 1] and landmarks[0, 0] < landmarks[16, 0]
    fitted = fit(landmarks, model=model, iterations=1)
    assert fitted.rmse < 0.05 * 180


def test_a_picture_of_the_mean_face_gives_its_own_landmarks(model):
    seen = Camera(2.0, np.eye(3), np.array([300.0, 300.0])).project(model.mean[model.landmarks].astype(float))
    np.testing.assert_allclose(landmarks_from(seen[[36, 45, 8]], model), seen, atol=1e-6)


def test_the_eyes_may_come_in_any_order(model):
    np.testing.assert_array_equal(landmarks_from(np.array(POINTS)[[1, 0, 2]], model), landmarks_from(POINTS, model))


@pytest.mark.parametrize(
    ("points", "complaint"),
    [
        (POINTS[:2], r"three finite points .* given shape \(2, 2\)"),
        ([*POINTS[:2], [np.nan, 0]], r"three finite points .* given \[nan, 0.0\] as point 2"),
        ([[0, 0], [100, 0], [50, 2]], "below the eyes"),
        ([[0, 0], [100, 0], [50, -80]], "below the eyes"),
        ([[5, 5], [5, 5], [5, 9]], "below the eyes"),
    ],
)
def test_points_that_span_no_face_are_refused(points, complaint, model):
    with pytest.raises(ValueError, match=complaint):
        landmarks_from(points, model)
