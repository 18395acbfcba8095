"""How people draw a face."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget.sketch import FEATURES, SILHOUETTE
from sketchwidget.sketch.hand import PART_LINES, PARTS, Hand

ANGLE = np.linspace(0, 2 * np.pi, 61)
CIRCLE = np.stack([np.sin(ANGLE), -np.cos(ANGLE)], axis=1)
ARC = np.stack([np.linspace(-1, 1, 25), np.linspace(-1, 1, 25) ** 2 - 1], axis=1)


def _face():
    lines = {SILHOUETTE: [0.5, 0.5] + CIRCLE * [0.27, 0.38] * (1 + 0.1 * np.cos(4 * ANGLE))[:, None]}
    for side, x in (("left", 0.61), ("right", 0.39)):
        lines[f"{side}_brow"] = [x, 0.36] + ARC * [0.06, 0.02]
        lines[f"{side}_eye_upper"] = [x, 0.45] + ARC * [0.04, 0.015]
        lines[f"{side}_eye_lower"] = [x, 0.45] + ARC * [0.04, -0.015]
        lines[f"{side}_ear"] = [0.5 + np.sign(x - 0.5) * 0.28, 0.5] + ARC[:, ::-1] * [0.02, 0.06]
    for name, width, height in (("mouth", 0.07, 0.02), ("lip", 0.08, 0.03)):
        lines |= {f"{name}_upper": [0.5, 0.7] + ARC * [width, height]}
        lines |= {f"{name}_lower": [0.5, 0.7] + ARC * [width, -height]}
    return lines | {"nose": [0.5, 0.57] - ARC * [0.04, 0.02]}


FACE = _face()
seeds = st.integers(0, 2**32 - 1)
hands = st.builds(
    Hand,
    tremor=st.floats(0, 0.02),
    misplacement=st.floats(0, 0.02),
    shorthand=st.floats(0, 1),
    extras=st.floats(0, 1),
)


def test_the_parts_have_all_lines_but_the_silhouette():
    assert set(PARTS) == {"outline", *PART_LINES}
    of_parts = [name for members in PART_LINES.values() for name in members]
    assert len(of_parts) == len(set(of_parts)) and set(of_parts) == set(FACE) - {SILHOUETTE}
    assert set(FEATURES) <= set(of_parts)


@given(seeds)
def test_a_hand_that_misplaces_nothing_means_the_lines_as_they_are(seed):
    intended = Hand(misplacement=0.0, shorthand=0.0).intend(FACE, np.random.default_rng(seed))
    assert list(intended) == list(FACE)
    for name, line in FACE.items():
        np.testing.assert_allclose(intended[name], line, atol=1e-12)


@given(hands, seeds)
def test_no_line_is_lost_and_none_is_added(hand, seed):
    given = FACE | {"scar": np.array([[0.4, 0.6], [0.42, 0.64]])}
    intended = hand.intend(given, np.random.default_rng(seed))
    assert {name: line.shape for name, line in intended.items()} == {name: line.shape for name, line in given.items()}
    assert all(np.isfinite(line).all() for line in intended.values())
    np.testing.assert_array_equal(intended["scar"], given["scar"])


@given(seeds)
def test_lines_of_a_part_move_and_stretch_together(seed):
    intended = Hand(misplacement=0.01, shorthand=0.0).intend(FACE, np.random.default_rng(seed))
    np.testing.assert_array_equal(intended[SILHOUETTE], FACE[SILHOUETTE])
    for members in PART_LINES.values():
        before, after = (np.concatenate([lines[name] for name in members]) for lines in (FACE, intended))
        assert np.abs(after - before).max() > 1e-6
        for axis in (0, 1):
            scale, offset = np.polyfit(before[:, axis], after[:, axis], 1)
            assert scale > 0
            np.testing.assert_allclose(scale * before[:, axis] + offset, after[:, axis], atol=1e-9)


def test_parts_are_as_far_out_of_place_as_the_hand_says():
    random, hand = np.random.default_rng(0), Hand(misplacement=0.01, shorthand=0.0)

    def middle(line):
        return (line.min(axis=0) + line.max(axis=0)) / 2

    moves = []
    for _ in range(400):
        intended = hand.intend(FACE, random)
        moves.append([middle(intended[name]) - middle(FACE[name]) for name in ("nose", "left_ear")])
    nose = np.array(moves)[:, 0]
    # Its own move, and that of all features together: half as wide as high.
    np.testing.assert_allclose(nose.std(axis=0), [0.01 * np.sqrt(2), 0.01 * np.sqrt(5)], rtol=0.15)
    np.testing.assert_allclose(nose.mean(axis=0), 0, atol=0.004)


@given(seeds)
def test_shorthand_makes_the_head_more_of_an_oval_and_leaves_its_box(seed):
    hand = Hand(misplacement=0.0, shorthand=1.0)
    silhouette = hand.intend(FACE, np.random.default_rng(seed))[SILHOUETTE]
    low, high = FACE[SILHOUETTE].min(axis=0), FACE[SILHOUETTE].max(axis=0)
    middle, half = (low + high) / 2, (high - low) / 2

    def off_the_oval(points):
        return np.abs(np.linalg.norm((points - middle) / half, axis=1) - 1).max()

    assert off_the_oval(silhouette) < 0.85 * off_the_oval(FACE[SILHOUETTE])
    np.testing.assert_allclose(silhouette.min(axis=0), low, atol=0.02)
    np.testing.assert_allclose(silhouette.max(axis=0), high, atol=0.02)


@given(hands, seeds, st.sets(st.sampled_from(PARTS)))
def test_drawn_parts_are_the_ones_asked_for(hand, seed, parts):
    drawn = hand.draw(FACE, parts, np.random.default_rng(seed))
    assert set(drawn) - {"extras"} == parts
    strokes = [stroke for part in drawn.values() for stroke in part]
    assert all(len(stroke) and np.isfinite(stroke).all() and np.abs(stroke - 0.5).max() < 1 for stroke in strokes)


@pytest.mark.parametrize(("extras", "share"), [(0.0, 0.0), (1.0, 1.0)])
def test_extras_are_as_frequent_as_the_hand_says(extras, share):
    random = np.random.default_rng(1)
    assert np.mean(["extras" in Hand(extras=extras).draw(FACE, {"nose"}, random) for _ in range(20)]) == share


@given(hands, seeds)
def test_the_same_seed_gives_the_same_drawing(hand, seed):
    def strokes():
        random = np.random.default_rng(seed)
        drawn = hand.draw(hand.intend(FACE, random), set(PARTS), random)
        return np.concatenate([stroke for part in drawn.values() for stroke in part])

    np.testing.assert_array_equal(strokes(), strokes())
