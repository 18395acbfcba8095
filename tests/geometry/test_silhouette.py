"""Silhouettes in a view, and the one that a stroke means."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sketchwidget.geometry.silhouette import nearest_silhouette, silhouettes

FRONT = np.eye(3)
BALL = trimesh.creation.icosphere(3, 10.0)


def together(*meshes):
    joined = trimesh.util.concatenate(meshes)
    return np.asarray(joined.vertices), np.asarray(joined.faces)


@settings(max_examples=20)
@given(st.integers(0, 10_000))
def test_the_silhouette_of_a_ball_is_its_equator(seed):
    turn = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    (chain,) = silhouettes(BALL.vertices, BALL.faces, turn)
    seen = BALL.vertices[chain] @ turn.T
    assert chain[0] == chain[-1] and len(set(chain.tolist())) == len(chain) - 1
    assert np.abs(seen[:, 2]).max() < 2.0  # edges are up to 1.6 long
    x, y = seen[:, 0], seen[:, 1]
    assert (x[:-1] * y[1:] - x[1:] * y[:-1]).sum() > 0  # the surface to the left: counterclockwise, y up


def test_a_box_is_seen_as_a_square():
    box = trimesh.creation.box(extents=(2, 2, 2))
    turn = Rotation.from_euler("y", 1e-3).as_matrix()  # edge on, the sides would neither face the viewer nor not
    (chain,) = silhouettes(box.vertices, box.faces, turn)
    assert {tuple(corner) for corner in box.vertices[chain][:, :2].tolist()} == {(-1, -1), (-1, 1), (1, -1), (1, 1)}


def test_what_is_hidden_is_no_silhouette():
    small = trimesh.creation.icosphere(3, 5.0)
    behind, beside = small.copy(), small.copy()
    behind.apply_translation([0, 0, -30])
    beside.apply_translation([10, 0, -30])
    assert len(silhouettes(*together(BALL, behind), FRONT)) == 1
    vertices, faces = together(BALL, beside)
    whole, part = sorted(silhouettes(vertices, faces, FRONT), key=lambda chain: -vertices[chain][:, 2].mean())
    assert whole[0] == whole[-1] and part[0] != part[-1]
    assert (np.hypot(*vertices[part][:, :2].T) > 9.0).all()


def test_the_rim_of_an_open_mesh_is_none():
    cap = BALL.faces[(BALL.vertices[BALL.faces][:, :, 2] > 3).all(axis=1)]
    assert silhouettes(BALL.vertices, cap, FRONT) == []


LINE = np.stack([np.linspace(0, 1, 21), np.zeros(21)], axis=1)
HIGHER = LINE + np.array([0, 1])
TWO = [np.arange(21), np.arange(21, 42)]
POINTS = np.concatenate([LINE, HIGHER])


@pytest.mark.parametrize("order", [1, -1])
def test_the_nearest_silhouette_is_dragged_onto_the_stroke(order):
    drag = nearest_silhouette((LINE + np.array([0, 0.3]))[::order], TWO, POINTS)
    assert sorted(drag.vertices.tolist()) == list(range(21))
    np.testing.assert_allclose(drag.displacement, np.tile([0, 0.3], (21, 1)), atol=1e-6)
    assert drag.distance == pytest.approx(0.3) and drag.angle == pytest.approx(0.0)
    assert set(nearest_silhouette(LINE + np.array([0, 0.6]), TWO, POINTS).vertices.tolist()) == set(range(21, 42))


def test_only_the_part_beside_the_stroke_is_dragged():
    drag = nearest_silhouette(LINE[5:16] + np.array([0, 0.1]), TWO, POINTS)
    assert drag.vertices.tolist() == list(range(5, 16))


@pytest.mark.parametrize("order", [1, -1])
def test_the_angle_to_a_stroke_is_that_between_their_directions(order):
    roof = LINE + np.array([0, 0.1]) + np.stack([np.zeros(21), 0.5 - np.abs(LINE[:, 0] - 0.5)], axis=1)
    assert nearest_silhouette(roof[::order], TWO[:1], POINTS).angle == pytest.approx(np.pi / 4)


def test_a_part_of_a_closed_chain_may_go_over_its_end():
    turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    chain = np.append(np.arange(60), 0)
    near = np.arange(-8, 9) % 60  # about vertex 0
    drag = nearest_silhouette(1.1 * circle[near], [chain], circle)
    assert drag.vertices.tolist() == near.tolist()
    np.testing.assert_allclose(drag.displacement, 0.1 * circle[near], atol=0.01)


def test_a_stroke_unlike_any_silhouette_means_none():
    assert nearest_silhouette(LINE, [], POINTS) is None
    assert nearest_silhouette(10 * LINE, TWO, POINTS) is None
    assert nearest_silhouette(0.02 * LINE, TWO, POINTS) is None
