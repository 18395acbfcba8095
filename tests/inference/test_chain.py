"""Which point of a drawn line is which, by the shares of its length."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget.inference.chain import Chains, around, halves, in_order, is_closed

# A line of length 1 bent at its middle, by points that are not evenly spaced.
SHARES = np.array([0.0, 0.1, 0.3, 0.5, 0.6, 0.8, 1.0])
LINE = np.stack([np.minimum(SHARES, 0.5), np.maximum(SHARES - 0.5, 0.0)], axis=1)


def part(start, end, count=41):
    """A stroke along the line between two shares of its length."""
    along = np.linspace(start, end, count)
    return np.stack([np.interp(along, SHARES, axis) for axis in LINE.T], axis=1)


def loop(count=200):
    """An egg, drawn clockwise on the canvas from its top."""
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return np.stack([0.5 + 0.3 * np.sin(angle), 0.5 - 0.4 * np.cos(angle) - 0.05 * np.cos(2 * angle)], axis=1)


def along(strokes):
    """The points of some strokes for those of the line, and which are drawn."""
    found, drawn = Chains([in_order(strokes, LINE)]).along(LINE[None])
    return found[0], drawn[0]


def test_a_stroke_twice_as_large_has_each_point_of_the_line():
    found, drawn = along([2 * part(0, 1)])
    np.testing.assert_allclose(found, 2 * LINE, atol=1e-3)
    assert drawn.all()


@given(st.permutations(range(3)), st.lists(st.booleans(), min_size=3, max_size=3))
def test_pieces_are_put_in_order_whichever_way_they_run(order, turned):
    pieces = [part(0, 0.33), part(0.34, 0.66), part(0.67, 1)]
    pieces = [pieces[k][::-1] if back else pieces[k] for k, back in zip(order, turned, strict=True)]
    found, drawn = along(pieces)
    np.testing.assert_allclose(found, LINE, atol=0.01)
    assert drawn.all()


def test_what_is_missing_at_an_end_is_not_drawn():
    found, drawn = along([part(0.5, 1)])
    np.testing.assert_array_equal(drawn, SHARES >= 0.5)
    np.testing.assert_allclose(found[drawn], LINE[drawn], atol=1e-3)


def test_lines_do_not_depend_on_each_other():
    others = [part(0, 1), 0.5 * part(0, 1)[::-1]]
    found, drawn = Chains(others).along(np.stack([LINE, 0.5 * LINE[::-1]]))
    np.testing.assert_allclose(found, [LINE, 0.5 * LINE[::-1]], atol=1e-3)
    assert drawn.all()


def test_strokes_over_each_other_are_no_chain():
    assert in_order([part(0, 0.7), part(0.3, 1)], LINE) is None
    assert in_order([part(0, 0.55), part(0.45, 1)], LINE) is not None


@pytest.mark.parametrize(
    "stroke", [np.concatenate([part(0, 1), part(0, 1)[::-1]]), part(0.5, 0.6), np.zeros((1, 2)), np.ones((3, 2))]
)
def test_there_and_back_a_crumb_and_a_dot_are_no_chain(stroke):
    assert in_order([stroke], LINE) is None


def test_a_closed_stroke_of_an_open_line_is_no_chain():
    there, back = part(0, 1), np.add(part(0, 1)[::-1], (0.0, 0.05))
    assert in_order([np.concatenate([there, back])], LINE) is None and in_order([loop()], LINE) is None


def test_a_chain_far_from_its_line_is_drawn_whole():
    found, drawn = Chains([part(0, 1)]).along(LINE[None] + 5.0)
    np.testing.assert_allclose(found[0], LINE, atol=1e-3)
    assert drawn.all()


def test_a_stroke_that_comes_back_is_closed():
    assert is_closed(loop()) and is_closed(loop()[:190]) and not is_closed(part(0, 1))


@pytest.mark.parametrize("first", [0, 70, 150])
@pytest.mark.parametrize("step", [1, -1])
def test_the_halves_of_a_loop_run_along_the_axis(first, step):
    rolled = np.roll(loop(), first, axis=0)[::step]
    upper, lower = halves(rolled, np.array([1.0, 0.0]))
    for half in (upper, lower):
        np.testing.assert_allclose(half[[0, -1], 0], [0.2, 0.8], atol=1e-3)
        assert (np.diff(half[:, 0]) > 0).all()
    assert upper[1:-1, 1].max() < lower[1:-1, 1].min() + 0.2 and upper[:, 1].mean() < 0.4 < lower[:, 1].mean()


@given(first=st.integers(0, 199), step=st.sampled_from([1, -1]), size=st.floats(0.9, 1.1))
def test_a_loop_has_the_points_of_a_line_wherever_it_was_begun_and_whichever_way_it_runs(first, step, size):
    line = loop(60)
    stroke = 0.5 + size * (np.roll(loop(), first, axis=0)[::step] - 0.5)
    np.testing.assert_allclose(around(stroke, line), 0.5 + size * (line - 0.5), atol=0.008)
