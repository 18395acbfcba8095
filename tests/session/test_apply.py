import numpy as np
import pytest

from sketchwidget.session import Clear, Draw, Erase, Mode, Modeller, Redo, State, Undo
from sketchwidget.session import apply as apply_with

STROKE = [[0.1, 0.2], [0.3, 0.4]]


@pytest.fixture
def apply(regressor):
    modeller = Modeller(regressor)
    return lambda state, event: apply_with(state, event, modeller)


def test_drawing_adds_an_unnamed_segment_and_leaves_the_former_state(apply):
    before = State()
    after = apply(before, Draw(STROKE))
    assert [segment.name for segment in after.sketch.segments] == ["unnamed"]
    np.testing.assert_allclose(after.sketch.segments[0].points, STROKE, rtol=1e-6)
    assert before == State()


def test_a_mirrored_stroke_is_two_segments(apply):
    sketch = apply(State(), Draw(STROKE, mirror=True)).sketch
    np.testing.assert_allclose(sketch.segments[1].points, [[0.9, 0.2], [0.7, 0.4]], rtol=1e-6)


def test_erasing_and_clearing(apply):
    drawn = apply(State(), Draw(STROKE))
    assert apply(drawn, Erase([[0.2, 0.3]], 0.5)) == State()
    assert apply(drawn, Clear()) == State()


@pytest.mark.parametrize("edit", [Clear(), Erase([[0.5, 0.5]], 0.1), Mode("initial")])
def test_an_edit_without_effect_gives_the_same_object(apply, edit):
    state = State()
    assert apply(state, edit) is state


@pytest.mark.parametrize("event", [Undo(), Redo()])
def test_undo_needs_a_history(apply, event):
    with pytest.raises(TypeError, match="an edit is"):
        apply(State(), event)
