"""Eyes, teeth and tongue behind the skin."""

import numpy as np
import pytest
import trimesh

from sketchwidget.face.cover import Cover

BALL = np.asarray(trimesh.creation.icosphere(3, 10.0).vertices)
SKIN = 1.2 * BALL  # 2 mm before the ball all round
HEAD = np.concatenate([BALL, SKIN]) + np.array([30.0, 0, 0])
INNER, OUTER = np.arange(len(BALL)), np.arange(len(BALL), 2 * len(BALL))
STILL = np.zeros_like(HEAD)


@pytest.fixture
def front():
    """A ball covered in front alone."""
    covered = BALL[:, 2] > 5
    return Cover(OUTER[covered], INNER[covered], INNER, room=0.5)


def test_a_part_goes_where_it_is_wanted_while_there_is_room(front):
    for wanted in ([0, 0, 1.4], [0, 0, -9.0], [0, 0, 0]):
        assert front.held(np.array(wanted), HEAD, STILL).tolist() == wanted


def test_a_part_stops_at_the_skin(front):
    held = front.held(np.array([0, 0, 5.0]), HEAD, STILL)
    np.testing.assert_allclose(held, [0, 0, 1.5], atol=0.05)


def test_skin_that_comes_in_pushes_the_part(front):
    pressed = STILL.copy()
    pressed[OUTER, 2] = -4.0
    held = front.held(np.zeros(3), HEAD, pressed)
    np.testing.assert_allclose(held, [0, 0, -2.5], atol=0.05)


def test_what_is_nearer_already_may_stay(front):
    near = HEAD.copy()
    near[OUTER] = HEAD[INNER]
    assert front.held(np.zeros(3), near, STILL).tolist() == [0, 0, 0]


def test_nothing_covers_nothing():
    none = np.empty(0, dtype=int)
    assert Cover(none, none, INNER, 0.5).held(np.ones(3), HEAD, STILL).tolist() == [1, 1, 1]
