import numpy as np
import pytest

from sketchwidget.caricature import fit


@pytest.fixture
def landmarks(drawn):
    return drawn[1].copy()


@pytest.mark.parametrize("shape", [(67, 2), (68, 3), (2, 68), (0, 2)])
def test_another_count_is_refused(shape):
    with pytest.raises(ValueError, match=rf"68 pairs.*given shape \({shape[0]}, {shape[1]}\)"):
        fit(np.zeros(shape))


@pytest.mark.parametrize("given", ["landmarks", None, [[1, 2], [3]]])
def test_what_is_no_array_is_refused(given):
    with pytest.raises(ValueError, match="68 pairs"):
        fit(given)


def test_landmarks_that_are_not_finite_are_named(landmarks):
    landmarks[[4, 40]] = np.nan
    with pytest.raises(ValueError, match="finite; not so those numbered 4, 40"):
        fit(landmarks)


def test_a_landmark_that_does_not_count_may_be_missing(landmarks, model):
    weights = np.ones(68)
    weights[[4, 40]] = 0
    whole = fit(landmarks, weights, model, iterations=1)
    landmarks[[4, 40]] = np.nan
    found = fit(landmarks, weights, model, iterations=1)
    np.testing.assert_allclose(found.vertices, whole.vertices, atol=1e-3)
    assert np.isnan(found.errors[[4, 40]]).all() and np.isfinite(found.rmse)


def test_landmarks_in_a_point_or_on_a_line_are_refused(landmarks):
    with pytest.raises(ValueError, match="68 that lie in one point"):
        fit(np.full((68, 2), 17.0))
    with pytest.raises(ValueError, match="68 that lie on a line"):
        fit(landmarks * [1, 0] + [0, 5])
    with pytest.raises(ValueError, match="68 that lie in 3 places"):
        fit(landmarks[[8, 17, 26]][np.arange(68) % 3])


def test_a_mirror_image_is_found(landmarks):
    with pytest.raises(ValueError, match="mirror image"):
        fit([400, 0] - landmarks * [1, -1])


def test_landmarks_with_y_going_up_are_found(landmarks):
    with pytest.raises(ValueError, match="upside down"):
        fit([0, 400] - landmarks * [-1, 1])


def test_a_face_on_its_head_is_found(landmarks):
    with pytest.raises(ValueError, match="stands on its head"):
        fit(400 - landmarks)


def test_weights_are_checked(landmarks):
    with pytest.raises(ValueError, match="68 finite numbers of at least 0"):
        fit(landmarks, np.ones(17))
    with pytest.raises(ValueError, match="68 finite numbers of at least 0"):
        fit(landmarks, -np.ones(68))
    with pytest.raises(ValueError, match="68 finite numbers of at least 0"):
        fit(landmarks, ["much"] * 68)
    with pytest.raises(ValueError, match="at least 8 landmarks; only 3"):
        fit(landmarks, np.arange(68) < 3)


def test_settings_are_checked(landmarks):
    with pytest.raises(ValueError, match="at least one; given 0"):
        fit(landmarks, iterations=0)
    with pytest.raises(ValueError, match=r"positive number; given -1"):
        fit(landmarks, pull=-1.0)
