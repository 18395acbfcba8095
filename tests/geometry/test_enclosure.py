"""The visible surface within a closed line."""

import numpy as np
import trimesh

from sketchwidget.geometry import View
from sketchwidget.geometry.enclosure import enclosed
from sketchwidget.geometry.view import rotation_about_y

VIEW = View(scale=0.01)  # 50 mm from the middle to the edge
BALL = trimesh.creation.icosphere(3, 20.0)


def square(half, x=0.5, y=0.5):
    return np.array([[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]])


def test_a_line_round_a_ball_holds_the_half_that_is_seen():
    everything = np.ones(len(BALL.vertices), dtype=bool)
    for degrees, axis in ((0, 2), (90, 0)):
        view = View(rotation_about_y(degrees), scale=0.01)
        found = enclosed(square(0.3), BALL.vertices, BALL.faces, view, everything)
        towards = BALL.vertices @ view.rotation[2]
        assert abs(view.rotation[2, axis]) > 0.9
        assert found[towards > 3].all() and not found[towards < -3].any()


def test_a_line_on_a_ball_holds_what_is_under_it():
    right = BALL.vertices[:, 0] > 0
    found = enclosed(square(0.05, x=0.6), BALL.vertices, BALL.faces, VIEW, right)
    x, y, z = BALL.vertices.T
    expected = (np.abs(x - 10) < 5) & (np.abs(y) < 5) & (z > 0)
    assert found.any() and (found == expected).all()
    assert not enclosed(square(0.05, x=0.4), BALL.vertices, BALL.faces, VIEW, right).any()
    assert not enclosed(square(0.05, x=0.9), BALL.vertices, BALL.faces, VIEW, right).any()


def test_what_is_hidden_in_a_pocket_is_held_too():
    """A lid over the middle of a wall: within a line about both, the covered part of the wall has no way out."""
    wall = trimesh.creation.box((80, 80, 2)).subdivide().subdivide().subdivide().subdivide()
    lid = trimesh.creation.box((30, 30, 2)).subdivide().subdivide()
    lid.apply_translation([0, 0, 10])
    both = trimesh.util.concatenate([wall, lid])
    x, y, z = both.vertices.T
    front = z == 1
    found = enclosed(square(0.25), both.vertices, both.faces, VIEW, np.ones(len(both.vertices), dtype=bool))
    assert found[front & (np.maximum(abs(x), abs(y)) < 24)].all()
    assert not found[z == -1].any() and not found[np.maximum(abs(x), abs(y)) > 26].any()
    narrow = enclosed(square(0.1), both.vertices, both.faces, VIEW, np.ones(len(both.vertices), dtype=bool))
    assert not narrow[front].any() and narrow.any()
