import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sketchwidget.geometry.camera import Camera

SIDEWAYS = Camera(1.7, Rotation.from_euler("yxz", [8, -4, 3], degrees=True).as_matrix(), np.array([256.0, 250.0]))
POINTS = np.random.default_rng(0).normal(size=(30, 3)) * [60, 80, 40]


def test_projects_by_hand():
    """A quarter turn about y brings what is in front to the right; y goes down in a picture."""
    turn = Rotation.from_euler("y", 90, degrees=True).as_matrix()
    camera = Camera(2.0, turn, np.array([100.0, 50.0]))
    np.testing.assert_allclose(camera.project([[0, 3, 10]]), [[120, 44]], atol=1e-12)
    np.testing.assert_allclose(camera.targets(np.array([[120.0, 44.0]])), [[10, 3]], atol=1e-12)


@given(st.floats(-70, 70), st.floats(-40, 40), st.floats(-60, 60), st.floats(0.1, 20))
def test_the_camera_of_a_picture_is_found(yaw, pitch, roll, scale):
    turn = Rotation.from_euler("YXZ", [yaw, pitch, roll], degrees=True).as_matrix()
    camera = Camera(scale, turn, np.array([300.0, -20.0]))
    found = Camera.fitted(POINTS, camera.project(POINTS), np.ones(30))
    assert found.scale == pytest.approx(scale, rel=1e-6)
    np.testing.assert_allclose(found.rotation, turn, atol=1e-6)
    np.testing.assert_allclose(found.project(POINTS), camera.project(POINTS), atol=1e-4 * scale)


def test_the_camera_of_a_picture_is_found_in_one_step():
    found = Camera.from_affine(POINTS, SIDEWAYS.project(POINTS), np.ones(30))
    assert found.scale == pytest.approx(SIDEWAYS.scale)
    np.testing.assert_allclose(found.rotation, SIDEWAYS.rotation, atol=1e-9)
    np.testing.assert_allclose(found.translation, SIDEWAYS.translation)


@pytest.mark.parametrize("way", [Camera.fitted, Camera.from_affine])
def test_a_point_of_no_weight_takes_no_part(way):
    camera = Camera(2.0, np.eye(3), np.array([10.0, 20.0]))
    pixels, weights = camera.project(POINTS), np.ones(30)
    pixels[3], weights[3] = [1e4, -1e4], 0
    found = way(POINTS, pixels, weights)
    np.testing.assert_allclose(found.rotation, np.eye(3), atol=1e-6)


def test_no_camera_near_by_is_better():
    noisy = Camera(2.0, np.eye(3), np.zeros(2)).project(POINTS) + np.random.default_rng(1).normal(size=(30, 2)) * 5
    found = Camera.fitted(POINTS, noisy, np.ones(30))
    least = ((found.project(POINTS) - noisy) ** 2).sum()
    for change in np.eye(3) * 1e-3:
        turned = Camera(found.scale, Rotation.from_rotvec(change).as_matrix() @ found.rotation, found.translation)
        assert ((turned.centred(POINTS, noisy, np.ones(30)).project(POINTS) - noisy) ** 2).sum() > least
    for scale in (0.999, 1.001):
        other = Camera(found.scale * scale, found.rotation, found.translation).centred(POINTS, noisy, np.ones(30))
        assert ((other.project(POINTS) - noisy) ** 2).sum() > least


def test_lifted_shifts_move_the_picture_and_keep_the_depth():
    shift = np.random.default_rng(4).normal(size=(30, 2)) * 8
    moved = POINTS + SIDEWAYS.lift(shift)
    np.testing.assert_allclose(SIDEWAYS.project(moved) - SIDEWAYS.project(POINTS), shift)
    np.testing.assert_allclose(SIDEWAYS.depth(moved), SIDEWAYS.depth(POINTS))


def test_a_head_turned_to_the_pictures_right_has_a_positive_yaw():
    assert SIDEWAYS.yaw == pytest.approx(8, abs=0.5)
    assert SIDEWAYS.project(np.array([0.0, 0, 100]))[0] > SIDEWAYS.translation[0]
