import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget.avatar.eyes import Eyeball, fit_eyeballs, gaze_names, sphere


def test_the_sphere_through_points_of_one():
    directions = np.random.default_rng(0).normal(size=(40, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    centre, radius = sphere(np.array([3.0, -2, 50]) + 12.5 * directions)
    assert np.allclose(centre, [3, -2, 50]) and np.isclose(radius, 12.5)


@pytest.mark.parametrize("side", ["left", "right"])
def test_gaze_turns_the_pupil_the_way_it_says(side):
    eye = Eyeball(side, np.array([0]), np.array([[0.0, 0, 1]]), np.zeros(3), 12.0)
    towards = {name: eye.points({name: 1.0})[0] for name in gaze_names(side)}
    up, down, inwards, outwards = towards.values()
    nose = -1 if side == "left" else 1  # x grows to the subject's left
    assert up[1] > 3 and down[1] < -3 and nose * inwards[0] > 3 and nose * outwards[0] < -3


@given(st.lists(st.floats(0, 1), min_size=4, max_size=4))
def test_an_eyeball_is_never_distorted(weights):
    directions = np.random.default_rng(1).normal(size=(20, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    eye = Eyeball("left", np.arange(20), directions, np.array([30.0, 0, 60]), 12.0)
    points = eye.points(dict(zip(gaze_names("left"), weights, strict=True)))
    assert np.allclose(np.linalg.norm(points - eye.centre, axis=1), 12.0)
    between = np.linalg.norm(points[:, None] - points, axis=2)
    assert np.allclose(between, np.linalg.norm(eye.points()[:, None] - eye.points(), axis=2))


def test_spheres_touch_the_lids_from_behind(model):
    eyes = fit_eyeballs(model, model.mean, model.mean)
    for eye in eyes:
        margin = np.concatenate([model.curves[f"{eye.side}_eye_{lid}"] for lid in ("upper", "lower")])
        away = np.linalg.norm(model.mean[margin] - eye.centre, axis=1)
        in_front = model.mean[margin, 2] > eye.centre[2]
        assert (away[in_front] > eye.radius - 0.6).all()
        assert 10 < eye.radius < 17
