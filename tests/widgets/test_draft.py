from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget.sketch import Sketch, erase
from sketchwidget.widgets.draft import Draft

# A line from left to right, a tenth of the canvas in 100 ms, the pressure rising.
LINE = np.array([[0.1 + 0.1 * n, 0.5, 0.1 * n, 100.0 * n] for n in range(9)])


def drawn(*strokes):
    draft = Draft()
    for stroke in strokes:
        draft.draw(stroke)
    return draft


def test_strokes_keep_pressure_and_time():
    np.testing.assert_allclose(drawn(LINE).strokes[0], LINE, atol=1e-6)


def test_a_cut_stroke_keeps_its_time_and_has_the_time_between_at_the_cut():
    draft = drawn(LINE)
    assert draft.erase([[0.45, 0.5]], 0.02)
    left, right = draft.strokes
    np.testing.assert_allclose(left[:-1], LINE[:4], atol=1e-6)
    np.testing.assert_allclose(left[-1], [0.43, 0.5, 0.33, 330.0], atol=1e-5)
    np.testing.assert_allclose(right[0], [0.47, 0.5, 0.37, 370.0], atol=1e-5)
    np.testing.assert_allclose(right[1:], LINE[4:], atol=1e-6)


def test_both_ends_of_a_fragment_may_lie_on_one_edge():
    draft = drawn(LINE[[0, 8]])
    assert draft.erase([[0.3, 0.5]], 0.05) and draft.erase([[0.7, 0.5]], 0.05)
    middle = draft.strokes[1]
    np.testing.assert_allclose(middle, [[0.35, 0.5, 0.25, 250.0], [0.65, 0.5, 0.55, 550.0]], atol=1e-5)


def test_a_stroke_that_crosses_itself_is_cut_on_the_way_that_was_erased():
    back = LINE[::-1] * [1, 1, 1, 0] + [0, 0, 0, 800.0] + LINE * [0, 0, 0, 1]
    there_and_back = np.concatenate([LINE[:-1], back])
    draft = drawn(there_and_back)
    assert draft.erase([[0.45, 0.5]], 0.02)
    first, turn, last = draft.strokes
    assert (first[-1, 3], turn[0, 3], turn[-1, 3], last[0, 3]) == pytest.approx((330, 370, 1230, 1270), abs=0.1)


def test_a_stroke_that_turns_back_is_cut_at_its_turn():
    draft = drawn(np.array([[0.0, 0.5, 0.5, 0.0], [1.0, 0.5, 0.5, 100.0], [0.0, 0.5, 0.5, 200.0]]))
    assert draft.erase([[1.0, 0.5]], 0.01)
    there, back = draft.strokes
    np.testing.assert_allclose([there[:, 3], back[:, 3]], [[0, 99], [101, 200]], atol=0.1)


points = st.lists(st.tuples(*[st.floats(0, 1, width=16)] * 3), min_size=1, max_size=12)
paths = st.lists(st.tuples(*[st.floats(0, 1, width=16)] * 2), min_size=1, max_size=3)


@given(st.lists(points, min_size=1, max_size=3), paths, st.sampled_from([0.01, 0.05, 0.2]))
def test_erasing_leaves_what_it_leaves_of_a_sketch_and_time_goes_on(strokes, path, radius):
    strokes = [np.column_stack([stroke, np.arange(len(stroke)) * 10.0]) for stroke in strokes]
    draft = drawn(*strokes)
    before = draft.sketch
    expected = erase(before, path, radius)
    assert draft.erase(path, radius) == (expected is not before)
    assert len(draft.strokes) == len(expected)
    for stroke, segment in zip(draft.strokes, expected.segments, strict=True):
        np.testing.assert_allclose(stroke[:, :2], segment.points, atol=1e-5)
        assert (np.diff(stroke[:, 3]) >= 0).all()


def test_erasing_where_nothing_is_changes_nothing():
    draft = drawn(LINE)
    before = draft.strokes
    assert not draft.erase([[0.5, 0.9]], 0.02)
    assert draft.strokes is before


def test_every_edit_can_be_undone_and_done_again():
    draft = Draft()
    assert not draft.undo() and not draft.redo() and not draft.clear()
    draft.draw(LINE)
    draft.erase([[0.45, 0.5]], 0.02)
    assert draft.clear() and draft.strokes == ()
    assert draft.undo() and len(draft.strokes) == 2
    assert draft.undo() and len(draft.strokes) == 1
    assert draft.redo() and draft.redo() and not draft.redo() and draft.strokes == ()
    draft.undo()
    draft.draw(LINE)
    assert not draft.can_redo and len(draft.strokes) == 3


def test_what_a_tablet_says_is_put_right_and_what_is_no_stroke_is_refused():
    draft = drawn([[0.1, 0.1, 1.2, 0], [0.2, 0.2, -0.1, 9], [0.3, 0.3, 0.5, 8.9]])
    np.testing.assert_allclose(draft.strokes[0][:, 2:], [[1, 0], [0, 9], [0.5, 9]], atol=1e-6)
    with pytest.raises(ValueError, match="within"):
        draft.draw([[0.1, 50.0, 0.5, 0]])
    assert len(draft.sketch) == 1 and isinstance(draft.sketch, Sketch)
