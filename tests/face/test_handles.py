import numpy as np
import pytest

from sketchwidget.face.handles import LINES
from sketchwidget.face.template import PARTS
from sketchwidget.geometry import View


@pytest.fixture
def targets(model):
    return {name: model.mean[model.curves[name], :2].astype(np.float64) for name in LINES}


def test_lines_that_stay_leave_the_head(model, targets):
    np.testing.assert_allclose(model.handles(model.mean, targets), model.mean, atol=1e-4)


def test_a_line_goes_where_it_is_drawn_and_depth_stays(model, targets):
    targets["left_brow"] += [1, 8]
    targets["mouth_lower"][:, 1] -= 6 * np.sin(np.linspace(0, np.pi, len(targets["mouth_lower"])))
    moved = model.handles(model.mean, targets)
    for name in LINES:
        assert np.abs(moved[model.curves[name], :2] - targets[name]).max() < 0.6, name
    np.testing.assert_array_equal(moved[:, 2], model.mean[:, 2])


def test_the_back_of_the_head_stays(model, targets):
    targets["nose"] *= 1.2
    moved = model.handles(model.mean, targets)
    back = model.mean[:, 2] < -60
    assert back.any() and np.abs(moved[back] - model.mean[back]).max() < 0.5


def test_the_surface_between_lines_is_smooth(model, targets):
    """An edge is stretched or turned at most as much as the raised brow asks of the skin beneath it."""
    targets["left_brow"] += [0, 10]
    moved = model.handles(model.mean, targets)
    edges = np.concatenate([model.faces[:, [0, 1]], model.faces[:, [1, 2]]])
    change = moved - model.mean
    assert np.linalg.norm(change, axis=1).max() < 12
    length = np.linalg.norm(model.mean[edges[:, 0]] - model.mean[edges[:, 1]], axis=1)
    strain = np.linalg.norm(change[edges[:, 0]] - change[edges[:, 1]], axis=1) / np.maximum(length, 0.5)
    assert strain.max() < 1.5


def test_an_eyeball_goes_with_the_corners_of_its_lids(model, targets):
    for name in ("left_eye_upper", "left_eye_lower"):
        targets[name] = 1.2 * (targets[name] - targets[name].mean(axis=0)) + targets[name].mean(axis=0) + [2, 3]
    moved = model.handles(model.mean, targets)
    eye = (model.template.fine_parts == PARTS.index("eyes")) & (model.mean[:, 0] > 0)
    other = (model.template.fine_parts == PARTS.index("eyes")) & (model.mean[:, 0] < 0)
    off = np.linalg.norm((model.mean - model.mean[eye].mean(axis=0))[:, :2], axis=1)
    seen = eye & (off < 7)  # mm: the rim, of 13, goes with the skin that hides it
    spread = [np.ptp(mesh[seen, :2], axis=0) for mesh in (model.mean, moved)]
    assert spread[1] / spread[0] == pytest.approx(1.2, rel=0.03)
    assert np.abs(moved[other] - model.mean[other]).max() < 0.5


def test_teeth_keep_their_shape(model, targets):
    for name in ("mouth_upper", "mouth_lower"):
        targets[name] += [4, -3]
    moved = model.handles(model.mean, targets)
    teeth = model.template.fine_parts == PARTS.index("teeth")
    shift = moved[teeth] - model.mean[teeth]
    assert shift[:, 0].mean() > 1.5 and shift[:, 1].mean() < -1
    upper = np.flatnonzero(teeth)[:50]
    before, after = (np.ptp(mesh[upper], axis=0) for mesh in (model.mean, moved))
    assert (after <= before + 1e-3).all() and (after > 0.9 * before).all()


def test_the_profile_runs_down_the_middle_of_the_face(model):
    profile = model.mean[model.handles.profile]
    assert np.abs(profile[:, 0]).max() < 1.0
    assert set(model.landmarks[[27, 30, 33, 51, 57, 8]]) <= set(model.handles.profile)
    assert profile[0, 1] > 90 and profile[-1, 1] < -90
    # It is what is seen of the face from the side: nothing of the skin's middle stands out before it.
    seen = View.preset("left").project(model.mean)
    assert View.preset("left").project(profile)[:, 0].min() == pytest.approx(seen[:, 0].min(), abs=2e-3)


def test_the_profile_is_dragged_and_the_front_keeps_its_lines(model, targets):
    height = np.abs(model.mean[model.handles.profile, 1] - model.mean[model.landmarks[30], 1])
    further = np.full((len(height), 2), np.nan)  # free between the tip of the nose and what stays
    further[height < 8] = [9, 0]
    further[height > 25] = 0
    moved = model.handles(model.mean, targets, further)
    tip = model.handles.profile[height < 8]
    assert np.abs(moved[tip, 2] - model.mean[tip, 2] - 9).max() < 0.6
    for name in LINES:
        assert np.abs(moved[model.curves[name], :2] - targets[name]).max() < 0.6, name
    assert np.abs(moved[:, 2] - model.mean[:, 2]).max() < 10
