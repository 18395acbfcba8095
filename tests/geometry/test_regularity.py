import numpy as np
import trimesh

from sketchwidget.geometry.regularity import folded, normals


def test_one_fold_by_hand():
    """Two triangles as an open book, then as a shut one."""
    faces = np.array([[0, 1, 2], [1, 0, 3]])
    open_book = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 1, 0], [0.5, -1, 0]])
    shut = open_book * [1, 1, 1]
    shut[3] = [0.5, 1, 0.1]
    assert folded(open_book, faces).tolist() == [False]
    assert folded(shut, faces).tolist() == [True]


def test_a_ball_has_no_fold_and_a_dent_has_some():
    ball = trimesh.creation.icosphere(subdivisions=2)
    vertices, faces = np.array(ball.vertices), np.array(ball.faces)
    assert len(folded(vertices, faces)) == len(ball.face_adjacency)
    assert not folded(vertices, faces).any()
    vertices[0] *= -1
    turned = ball.face_adjacency_angles
    dented = trimesh.Trimesh(vertices, faces, process=False).face_adjacency_angles
    assert folded(vertices, faces).sum() == (dented > np.pi / 2).sum() > 0 == (turned > np.pi / 2).sum()


def test_normals_by_hand():
    vertices = np.array([[0.0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 3]])
    np.testing.assert_allclose(normals(vertices, np.array([[0, 1, 2], [2, 0, 3]])).T, [[0, 0, 2], [-3, 0, 0]])
