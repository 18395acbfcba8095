"""Lines removed and deformed at random."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from sketchwidget.sketch import LINE_NAMES, Segment, Sketch, arc_length
from sketchwidget.sketch.augment import deform_lines, remove_lines

points = hnp.arrays(np.float32, st.tuples(st.integers(1, 12), st.just(2)), elements=st.floats(0, 1, width=32))
sketches = st.lists(st.builds(Segment, st.sampled_from(LINE_NAMES), points), max_size=12).map(Sketch)
seeds = st.integers(0, 2**32 - 1)

ANGLE = np.linspace(0, 2 * np.pi, 61)
CIRCLE = 0.5 + 0.4 * np.stack([np.cos(ANGLE), np.sin(ANGLE)], axis=1)
CIRCLE[-1] = CIRCLE[0]


def rows(lengths, name="nose"):
    return [Segment(name, np.array([[0.1, y], [0.1 + length, y]])) for y, length in enumerate(lengths)]


@given(sketches, seeds, st.floats(0, 1))
def test_what_stays_is_unchanged_and_in_its_order(sketch, seed, share):
    left = remove_lines(sketch, np.random.default_rng(seed), share)
    assert len(left) == len(sketch) - round(share * len(sketch))
    remaining = iter(sketch.segments)
    assert all(any(kept is segment for segment in remaining) for kept in left.segments)


@given(sketches, seeds)
def test_the_same_seed_gives_the_same_drawing(sketch, seed):
    once, again = (np.random.default_rng(seed) for _ in range(2))
    assert remove_lines(sketch, once, 0.5) == remove_lines(sketch, again, 0.5)
    assert deform_lines(sketch, once) == deform_lines(sketch, again)


def test_short_lines_and_late_ones_go_first():
    random = np.random.default_rng(0)

    def survival(sketch, **weights):
        left = [remove_lines(sketch, random, 0.5, **weights).segments for _ in range(2000)]
        return [np.mean([segment in kept for kept in left]) for segment in sketch.segments]

    assert (np.diff(survival(Sketch(rows([0.1, 0.2, 0.4, 0.8])), order=0.0)) > 0.03).all()
    assert (np.diff(survival(Sketch(rows([0.1, 0.1, 0.1, 0.1])))) < -0.03).all()
    wrinkle_first = Sketch([*rows([0.1], "wrinkle"), Segment("nose", [[0, 1], [0.1, 1]])])
    assert np.subtract(*survival(wrinkle_first)) < -0.5


@pytest.mark.parametrize("share", [-0.1, 1.1, np.nan])
def test_a_share_that_is_none_is_refused(share):
    with pytest.raises(ValueError, match="between 0 and 1"):
        remove_lines(Sketch(), np.random.default_rng(0), share)


@given(sketches, seeds)
def test_without_noise_nothing_moves(sketch, seed):
    still = deform_lines(sketch, np.random.default_rng(seed), local=0.0, overall=0.0)
    for before, after in zip(sketch.segments, still.segments, strict=True):
        assert after.name == before.name
        np.testing.assert_allclose(after.points, before.points, atol=1e-5)


@given(sketches, seeds)
@settings(max_examples=50)
def test_deformed_lines_keep_names_and_numbers_of_points(sketch, seed):
    bent = deform_lines(sketch, np.random.default_rng(seed))
    assert [(s.name, s.points.shape) for s in bent.segments] == [(s.name, s.points.shape) for s in sketch.segments]


@given(seeds)
def test_a_closed_line_stays_closed_and_smooth(seed):
    (closed,) = deform_lines(Sketch([Segment("silhouette", CIRCLE)]), np.random.default_rng(seed)).segments
    np.testing.assert_array_equal(closed.points[0], closed.points[-1])
    assert np.abs(closed.points - CIRCLE).max() < 0.1
    assert arc_length(closed.points)[-1] < 1.15 * arc_length(CIRCLE)[-1]


def test_short_straight_lines_stray_further_than_long_or_curved_ones():
    arc = CIRCLE[:45]
    length = arc_length(arc)[-1]
    lines = [np.array([[0.2, 0.5], [0.2 + reach, 0.5]]) for reach in (0.05, length)]
    sketch = Sketch([Segment("nose", line) for line in (*lines, arc)])
    random = np.random.default_rng(0)
    moved = [deform_lines(sketch, random, overall=0.0).segments for _ in range(400)]
    stray = [
        np.sqrt(np.mean([(drawn[i].points[[0, -1]] - sketch.segments[i].points[[0, -1]]) ** 2 for drawn in moved]))
        for i in range(3)
    ]
    assert stray[0] > 1.5 * stray[1] > 1.5 * stray[2]
    assert 0.002 < stray[0] < 0.004
