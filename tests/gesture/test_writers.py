"""Simulated writers draw the gestures that they are asked for."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sketchwidget.gesture import GESTURES, shapes
from sketchwidget.gesture.others import other
from sketchwidget.gesture.writers import Writer

seeds = st.integers(0, 100_000)


def loops(path):
    """How often a line crosses itself."""
    a, b = path[:-1, None], path[1:, None]
    c, d = path[None, :-1], path[None, 1:]

    def side(p, q, r):
        return np.sign((q - p)[..., 0] * (r - p)[..., 1] - (q - p)[..., 1] * (r - p)[..., 0])

    crossing = (side(a, b, c) != side(a, b, d)) & (side(c, d, a) != side(c, d, b))
    apart = np.abs(np.subtract.outer(np.arange(len(path) - 1), np.arange(len(path) - 1))) > 1
    return int((crossing & apart).sum()) // 2


def test_the_names_are_those_of_the_paper_s_figure():
    assert (
        *("line", "region", "left arrow", "right arrow"),
        *("up roll 1", "up roll 2", "up roll 3", "down roll 1", "down roll 2", "down roll 3"),
    ) == GESTURES
    assert set(shapes.EXAMPLES) == set(GESTURES)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_roll_has_its_loops_above_the_line_it_stands_on(count):
    roll = shapes.roll(count)
    assert loops(roll) == count
    assert np.isclose(roll[:, 1].max(), 0.0, atol=1e-3) and np.isclose(
        roll[:, 1].min(), -1.0, atol=0.01
    )  # y down: up is negative
    assert loops(shapes.roll(count, heights=np.linspace(0.5, 1.5, count), flat=0.3)) == count


def test_an_arrow_points_to_the_right():
    arrow = shapes.arrow(barbs=(0.3, 0.5), angles=(0.5, 0.9))
    assert arrow[1].tolist() == [0, 0] and (arrow[:, 0] <= 0).all()
    assert np.isclose(np.hypot(*arrow[2]), 0.3) and np.isclose(np.hypot(*arrow[4]), 0.5)
    assert arrow[2, 1] < 0 < arrow[4, 1]
    assert len(shapes.arrow(0.0)) == 3


def test_a_region_closes():
    path = shapes.region(0.5, (0.1, 0.05, 0.02), 0.3)
    np.testing.assert_allclose(path[0], path[-1], atol=1e-12)
    assert loops(path[:-1]) == 0


def test_a_writer_is_always_the_same_and_each_is_another():
    assert Writer.random(3) == Writer.random(3) != Writer.random(4)
    first, again = (Writer.random(3).draw("region", np.random.default_rng(5)) for _ in range(2))
    np.testing.assert_array_equal(first, again)


@settings(max_examples=50)
@given(seeds, st.sampled_from(GESTURES))
def test_what_is_drawn_lies_on_the_canvas(seed, name):
    random = np.random.default_rng(seed)
    for stroke in (Writer.random(seed).draw(name, random), other(Writer.random(seed), random)):
        assert stroke.dtype == np.float32 and stroke.ndim == 2 and len(stroke) >= 8
        assert np.isfinite(stroke).all() and stroke.min() > -0.01
        assert np.ptp(stroke, axis=0).max() > 0.03


def test_an_unknown_gesture_is_an_error():
    with pytest.raises(ValueError, match="given 'circle'"):
        Writer().draw("circle", np.random.default_rng(0))


def test_slant_leans_to_the_right():
    upright, slanted = (
        Writer(slant=slant, tremor=0.0).write(np.array([[0, 1], [0, 0.5], [0, 0]]), np.random.default_rng(0))
        for slant in (0.0, 0.8)
    )
    assert abs(upright[-1, 0] - upright[0, 0]) < 0.2 * np.ptp(upright[:, 1])
    assert slanted[-1, 0] - slanted[0, 0] > 0.4 * np.ptp(slanted[:, 1])
