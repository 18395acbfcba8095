from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget.session import Clear, Draw, Erase, History, Modeller, Redo, State, Undo, apply
from sketchwidget.session import history as session_history
from sketchwidget.session.history import KEPT_STATES

MODELLER = Modeller(SimpleNamespace(infer=print))  # none of these edits needs a head

coordinates = st.floats(0, 1, width=32)
points = st.lists(st.tuples(coordinates, coordinates).map(list), min_size=1, max_size=4)
edits = st.one_of(
    st.builds(Draw, points, mirror=st.booleans()),
    st.builds(Erase, points, st.floats(0.01, 0.4)),
    st.builds(Clear),
)
events = st.lists(st.one_of(edits, edits, st.builds(Undo), st.builds(Redo)), max_size=25)


def dot(i):
    return Draw([[i / 1000, 0.5]])


def same_bits(state, other):
    pairs = zip(state.sketch.segments, other.sketch.segments, strict=True)
    return state == other and all(a.points.tobytes() == b.points.tobytes() for a, b in pairs)


def test_undo_and_redo_walk_the_line_of_edits():
    history = History(MODELLER)
    assert not history.can_undo
    assert not history.can_redo
    history.record(dot(1))
    one = history.state
    history.record(dot(2))
    two = history.state
    assert history.record(Undo())
    assert history.state == one
    assert history.can_redo
    assert history.record(Redo())
    assert history.state == two
    assert not history.record(Redo())


def test_what_was_taken_back_is_dropped_by_a_new_edit():
    history = History(MODELLER)
    for event in (dot(1), Undo(), dot(2)):
        assert history.record(event)
    assert not history.can_redo
    assert not history.record(Redo())


def test_what_has_no_effect_is_not_kept():
    history = History(MODELLER)
    assert not history.record(Undo())
    assert not history.record(Clear())
    assert history.record(dot(1))
    assert history.record(Undo())
    assert not history.record(Clear())
    assert history.can_redo


def test_undo_beyond_the_kept_states_gives_the_states_that_were():
    history, states = History(MODELLER), [State()]
    n = 2 * KEPT_STATES + 20
    for i in range(n):
        history.record(dot(i) if i % 10 else Erase([[i / 1000, 0.5]], 0.0035) if i else dot(0))
        states.append(history.state)
    for state in reversed(states[:-1]):
        assert history.record(Undo())
        assert same_bits(history.state, state)
    assert not history.can_undo
    for state in states[1:]:
        assert history.record(Redo())
        assert same_bits(history.state, state)


@pytest.mark.parametrize(("steps", "failing"), [(KEPT_STATES, Undo()), (1, Redo())], ids=["undo", "redo"])
def test_an_undo_or_redo_that_is_interrupted_changes_nothing(monkeypatch, steps, failing):
    history = History(MODELLER)
    for i in range(KEPT_STATES + 2):
        history.record(dot(i))
    for _ in range(steps):
        history.record(Undo())
    before, state = (history.can_undo, history.can_redo), history.state
    with monkeypatch.context() as patch:
        patch.setattr(session_history, "apply", interrupted)
        with pytest.raises(KeyboardInterrupt):
            history.record(failing)
    assert history.state is state and (history.can_undo, history.can_redo) == before
    step = 1 if isinstance(failing, Redo) else -1
    assert history.record(failing) and len(history.state.sketch) == len(state.sketch) + step


def interrupted(*_):
    raise KeyboardInterrupt


def test_kept_states_are_the_states_themselves():
    history = History(MODELLER)
    history.record(dot(1))
    kept = history.state
    history.record(dot(2))
    history.record(Undo())
    assert history.state is kept


@given(events)
def test_undoing_everything_gives_back_the_empty_sketch(events):
    history = History(MODELLER)
    for event in events:
        history.record(event)
    while history.can_undo:
        assert history.record(Undo())
    assert history.state == State()


@given(events)
def test_a_history_is_the_edits_that_count(events):
    history, done, undone = History(MODELLER), [], []
    for event in events:
        effective = history.record(event)
        match event:
            case Undo() if effective:
                undone.append(done.pop())
            case Redo() if effective:
                done.append(undone.pop())
            case Draw() | Erase() | Clear() if effective:
                done, undone = [*done, event], []
        assert (history.can_undo, history.can_redo) == (bool(done), bool(undone))
    state = State()
    for edit in done:
        state = apply(state, edit, MODELLER)
    assert same_bits(history.state, state)
