import numpy as np
import pytest
import trimesh

from sketchwidget.geometry import rotation_about_y
from sketchwidget.geometry.local_frames import local_frames


@pytest.fixture
def ball():
    mesh = trimesh.creation.icosphere(2)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def test_frames_of_a_flat_triangle_worked_by_hand():
    frames = local_frames([[0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    np.testing.assert_allclose(frames[0], np.eye(3), atol=1e-7)
    np.testing.assert_allclose(frames[1][:, 0], [-(0.5**0.5), 0.5**0.5, 0], atol=1e-6)


def test_frames_are_rotations_whose_third_direction_is_the_normal(ball):
    vertices, faces = ball
    frames = local_frames(vertices, faces)
    np.testing.assert_allclose(frames.transpose(0, 2, 1) @ frames, np.broadcast_to(np.eye(3), frames.shape), atol=1e-5)
    np.testing.assert_allclose(np.linalg.det(frames), 1, atol=1e-5)
    assert (frames[:, :, 2] * vertices).sum(axis=1).min() > 0.99


def test_frames_turn_with_the_mesh(ball):
    vertices, faces = ball
    turn = rotation_about_y(70.0)
    np.testing.assert_allclose(local_frames(vertices @ turn.T, faces), turn @ local_frames(vertices, faces), atol=1e-5)


def test_a_vertex_without_a_face_is_an_error(ball):
    vertices, faces = ball
    with pytest.raises(ValueError, match="1 are in none"):
        local_frames(np.append(vertices, [[0, 0, 0]], axis=0), faces)
