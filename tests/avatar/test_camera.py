import numpy as np


def test_the_camera_is_found_from_what_it_shows(camera):
    points = np.random.default_rng(1).normal(size=(30, 3)) * 60
    found = type(camera).of(points, camera.project(points), np.ones(30))
    assert np.allclose(found.rotation, camera.rotation, atol=1e-6)
    assert np.isclose(found.scale, camera.scale) and np.allclose(found.translation, camera.translation)


def test_points_without_weight_do_not_matter(camera):
    points = np.random.default_rng(2).normal(size=(30, 3)) * 60
    pixels = camera.project(points)
    pixels[0] += 500
    weights = np.ones(30)
    weights[0] = 0
    assert np.allclose(type(camera).of(points, pixels, weights).rotation, camera.rotation, atol=1e-6)


def test_lifted_shifts_move_the_picture_and_keep_the_depth(camera):
    points = np.random.default_rng(3).normal(size=(5, 3)) * 60
    shift = np.random.default_rng(4).normal(size=(5, 2)) * 8
    moved = points + camera.lift(shift)
    assert np.allclose(camera.project(moved) - camera.project(points), shift)
    assert np.allclose(camera.depth(moved), camera.depth(points))


def test_a_head_turned_to_the_pictures_right_has_a_positive_yaw(camera):
    assert np.isclose(camera.yaw, 8, atol=0.5)
    nose = camera.project(np.array([[0.0, 0, 100]]))[0]
    assert nose[0] > camera.translation[0]
