"""Finding the outline of a head among freehand strokes, and its frame."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget.geometry import View
from sketchwidget.inference.framing import OUTLINE_SIZE, Frame, place
from sketchwidget.inference.naming import whereabouts
from sketchwidget.inference.outline import find_outline

ANGLE = np.linspace(0, 2 * np.pi, 80)
CIRCLE = np.stack([np.cos(ANGLE), np.sin(ANGLE)], axis=1)
OVAL = [0.5, 0.5] + CIRCLE * [0.27, 0.38]
EYE = [0.4, 0.45] + CIRCLE * [0.05, 0.02]
SMILE = np.array([[0.38, 0.66], [0.44, 0.71], [0.5, 0.72], [0.56, 0.71], [0.62, 0.66]])
HAIR = np.array([[0.22, 0.5], [0.24, 0.25], [0.36, 0.09], [0.5, 0.05], [0.64, 0.09], [0.76, 0.25], [0.78, 0.5]])
JAW = OVAL[(OVAL[:, 1] > 0.42)]
JAW = JAW[np.argsort(np.arctan2(JAW[:, 0] - 0.5, -(JAW[:, 1] - 0.42)) % (2 * np.pi))]


def test_oval_is_the_outline_whatever_comes_before_or_after():
    for strokes in ([OVAL], [EYE, OVAL], [OVAL, EYE, SMILE], [OVAL, HAIR, EYE], [SMILE, EYE, HAIR, OVAL]):
        found = find_outline(strokes)
        assert found is not None
        assert strokes[found.strokes[0]] is OVAL and len(found.strokes) == 1


@pytest.mark.parametrize("strokes", [[], [EYE], [SMILE], [EYE, SMILE], [OVAL[:2]], [OVAL[:1]], [np.ones((5, 2))]])
def test_no_outline_where_none_is_drawn(strokes):
    assert find_outline(strokes) is None


def test_a_scribble_is_no_outline():
    random = np.random.default_rng(0)
    assert find_outline([0.5 + np.cumsum(random.normal(0, 0.05, (200, 2)), axis=0) % 0.4]) is None


def test_two_halves_that_meet_are_one_outline():
    right, left = np.roll(OVAL[:-1], 20, axis=0)[:41], np.roll(OVAL[:-1], 20, axis=0)[39:]
    found = find_outline([right, left, EYE])
    assert found is not None and sorted(found.strokes) == [0, 1]


def test_a_jaw_open_at_the_top_is_an_outline_and_an_arch_is_none():
    assert find_outline([JAW, EYE, SMILE]).strokes == (0,)
    assert find_outline([[0.0, 1.0] + JAW * [1, -1]]) is None


@given(st.floats(0.35, 1.2), st.floats(-0.2, 0.4), st.floats(-0.2, 0.4))
def test_frame_takes_away_place_and_size(scale, x, y):
    moved = scale * OVAL + [x, y]
    np.testing.assert_allclose(Frame.of_outline(moved)(moved), Frame.of_outline(OVAL)(OVAL), atol=1e-5)
    low, high = Frame.of_outline(moved)(moved).min(axis=0), Frame.of_outline(moved)(moved).max(axis=0)
    assert np.sqrt(np.prod(high - low)) == pytest.approx(OUTLINE_SIZE, abs=1e-5)


def test_a_flat_outline_has_no_frame():
    with pytest.raises(ValueError, match="width and height"):
        Frame.of_outline(np.array([[0, 0.5], [1, 0.5]]))


@given(st.floats(0.5, 1.5), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_placing_finds_a_known_view(scale, x, y):
    view = place(OVAL, scale * OVAL + [x, y])
    np.testing.assert_allclose(view.scale, View().scale * scale, rtol=1e-3)
    np.testing.assert_allclose(view.centre, np.array([0.5, 0.5]) * scale + [x, y], atol=2e-3)


def test_placing_on_an_open_jaw_finds_the_same_view():
    view = place(OVAL, 0.8 * JAW + [0.1, 0.05])
    np.testing.assert_allclose(view.scale, 0.8 * View().scale, rtol=0.02)
    np.testing.assert_allclose(view.centre, [0.5, 0.45], atol=0.01)


def test_ears_and_inner_strokes_belong_to_the_face_and_hair_does_not():
    outline = find_outline([OVAL])
    ear = np.array([[0.23, 0.44], [0.19, 0.43], [0.18, 0.5], [0.2, 0.57], [0.24, 0.58]])
    neck = np.array([[0.42, 0.88], [0.41, 0.98]])
    curl = HAIR[:3] + np.array([-0.05, 0.0])
    places = whereabouts([OVAL, EYE, ear, HAIR, neck, curl], outline)
    assert places == ["inside", "inside", "ear", "outside", "outside", "outside"]
