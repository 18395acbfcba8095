import subprocess
import sys

import numpy as np
import pytest
import threadpoolctl
import traitlets
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sketchwidget.files import textfile
from sketchwidget.session import Clear, Draw, Erase, Mode, Redo, Session, SessionFileError, Undo
from sketchwidget.sketch import Sketch
from sketchwidget.sketch.sketch import MAX_STROKES

STROKE = [[0.1, 0.2], [0.3, 0.4]]
TRAITS = ("sketch", "face", "frame", "timings", "can_undo", "can_redo")

coordinates = st.floats(-0.5, 1.5)
points = st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=4)
actions = st.lists(
    st.one_of(
        st.tuples(st.just("draw"), points),
        st.tuples(st.just("erase"), points, st.floats(0.01, 0.4)),
        st.tuples(st.sampled_from(["undo", "redo", "clear"])),
    ),
    max_size=15,
)


@pytest.fixture
def session(regressor):
    return Session(regressor)


def snapshot(session):
    return {name: getattr(session, name) for name in ("mode", *TRAITS)}, session.events


def test_a_session_starts_empty_with_the_mean_face(session):
    assert session.mode == "initial"
    assert session.sketch == Sketch()
    assert session.face.sketch == Sketch()
    assert session.events == ()
    assert not session.can_undo
    assert not session.can_redo


def test_a_stroke_gives_a_face_and_names_the_lines(session, regressor):
    session.draw(STROKE)
    session.draw([[0.5, 0.5]], mirror=True)
    assert list(session.sketch.lines) == ["silhouette", "wrinkle"]
    assert len(session.sketch) == 3
    assert sum(map(len, session.face.sketch.lines["unnamed"])) == 4
    assert session.can_undo
    assert regressor.asked == 2


def test_a_preview_is_what_a_stroke_would_give_and_changes_nothing(session):
    session.draw([(0.2, 0.5), (0.8, 0.5)])
    before = (session.face, session.sketch, session.events)
    preview = session.preview([(0.4, 0.7), (0.6, 0.7)], mirror=True)
    assert (session.face, session.sketch, session.events) == before
    session.draw([(0.4, 0.7), (0.6, 0.7)], mirror=True)
    assert preview.face.sketch.renamed(preview.names) == session.sketch


def test_actions_are_events(session):
    session.draw(STROKE)
    session.erase([[0.2, 0.3]], radius=0.05)
    session.undo()
    session.redo()
    session.clear()
    assert session.events == (Draw(STROKE), Erase([[0.2, 0.3]], 0.05), Undo(), Redo(), Clear())


def test_the_eraser_takes_a_point_or_a_path(session):
    session.draw(STROKE)
    assert session.erase((0.2, 0.3))
    assert len(session.sketch) == 2
    assert session.erase(STROKE)
    assert session.sketch == Sketch()


def test_what_has_no_effect_is_neither_recorded_nor_inferred(session, regressor):
    session.draw(STROKE)
    before = snapshot(session)
    assert not session.erase([[0.9, 0.9]])
    assert not session.redo()
    assert snapshot(session) == before
    assert session.undo()
    assert not session.undo()
    assert not session.clear()
    assert session.events == (Draw(STROKE), Undo())
    assert regressor.asked == 2


def test_a_stroke_takes_one_thread_and_leaves_others_theirs(session, regressor, monkeypatch):
    def threads():
        return {pool["num_threads"] for pool in threadpoolctl.threadpool_info()}

    infer, during = regressor.infer, []
    monkeypatch.setattr(regressor, "infer", lambda sketch: during.append(threads()) or infer(sketch))
    with threadpoolctl.threadpool_limits(3):
        session.draw(STROKE)
        session.preview([[0.5, 0.5], [0.6, 0.6]])
        assert during == [{1}, {1}]
        assert threads() == {3}


def test_undo_gives_the_former_face(session):
    session.draw(STROKE)
    former = session.sketch, session.face
    session.draw([[0.5, 0.5]])
    session.undo()
    assert (session.sketch, session.face) == former
    assert session.can_redo
    session.undo()
    assert session.sketch == Sketch()
    assert not session.can_undo


def test_timings_tell_the_steps_of_the_last_change(session):
    session.draw(STROKE)
    assert session.timings.keys() == {"sketch", "network", "inference", "total"}
    assert session.timings["network"] == 1.5
    assert 0 <= session.timings["sketch"] + session.timings["inference"] <= session.timings["total"]


@pytest.mark.parametrize(
    "act",
    [
        lambda session: session.draw([]),
        lambda session: session.draw([[0.1, np.nan]]),
        lambda session: session.draw([[5, 5]]),
        lambda session: session.draw("line"),
        lambda session: session.draw(STROKE, view="left"),
        lambda session: session.draw(STROKE, mirror=None),
        lambda session: session.erase([]),
        lambda session: session.erase(None),
        lambda session: session.erase([[0.2, 0.3]], radius=-1),
    ],
)
def test_a_bad_action_is_an_error_and_changes_nothing(session, act):
    session.draw(STROKE)
    before = snapshot(session)
    with pytest.raises(ValueError, match=r"a stroke|radius|mirror|the profile"):
        act(session)
    assert snapshot(session) == before


def test_the_mode_is_switched_by_assignment_and_switching_is_an_edit(session):
    session.draw(STROKE)
    seen = []
    session.observe(lambda change: seen.append(change.new), "mode")
    session.mode = "refine"
    session.mode = "refine"
    assert session.undo() and session.mode == "initial"
    assert seen == ["refine", "initial"]
    assert session.events == (Draw(STROKE), Mode("refine"), Undo())
    with pytest.raises(ValueError, match="in the mode"):
        session.mode = "finished"
    assert session.mode == "initial"


@pytest.mark.parametrize("name", TRAITS)
def test_traits_are_for_reading(session, name):
    with pytest.raises(traitlets.TraitError, match="read-only"):
        setattr(session, name, getattr(session, name))


@pytest.mark.parametrize("observed", ["sketch", "face", "frame", "timings"])
def test_an_observer_sees_a_consistent_whole(session, observed):
    seen = []
    session.observe(lambda _: seen.append((session.sketch, session.face, session.can_undo)), observed)
    for act in (lambda: session.draw(STROKE), lambda: session.draw([[0.5, 0.5]]), session.undo, session.undo):
        act()
        for sketch, face, can_undo in seen:
            assert [s.points.tobytes() for s in sketch.segments] == [s.points.tobytes() for s in face.sketch.segments]
            assert can_undo == bool(len(sketch))
        assert seen.pop() == (session.sketch, session.face, session.can_undo)


def test_an_observer_may_act(session):
    session.observe(lambda change: session.undo() if len(change.new) == 2 else None, "sketch")
    session.draw(STROKE)
    session.draw([[0.5, 0.5]])
    assert len(session.sketch) == 1
    assert session.events[-1] == Undo()


def test_a_failing_inference_keeps_the_drawing(session, regressor, monkeypatch):
    session.draw(STROKE)
    face = session.face

    def fail(_):
        raise RuntimeError("no memory")

    monkeypatch.setattr(regressor, "infer", fail)
    with pytest.raises(RuntimeError, match="no memory"):
        session.draw([[0.5, 0.5]])
    assert len(session.sketch) == 2
    assert len(session.events) == 2
    assert session.face is face
    assert session.timings.keys() == {"sketch", "total"}
    monkeypatch.undo()
    session.undo()
    assert session.face == face
    assert len(session.sketch) == 1


def test_a_full_sketch_takes_no_more(session):
    text = '{"event":"draw","points":[[0.5,0.5]],"view":"front","mirror":true}\n'
    half = MAX_STROKES // 2
    header = '{"format":"sketchwidget session","version":1,"events":%d}\n'
    full = Session.loads(header % half + half * text, session.regressor)
    assert len(full.sketch) == MAX_STROKES
    before = snapshot(full)
    with pytest.raises(ValueError, match="at most 20,000"):
        full.draw(STROKE)
    assert snapshot(full) == before
    with pytest.raises(SessionFileError, match=f"line {half + 2} of the session cannot be replayed: .* at most 20,000"):
        Session.loads(header % (half + 1) + (half + 1) * text, session.regressor)


def test_loading_infers_once(session, regressor):
    for _ in range(5):
        session.draw(STROKE)
    regressor.asked = 0
    again = Session.loads(session.dumps(), regressor)
    assert regressor.asked == 1
    assert again.face == session.face


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(actions)
def test_a_replayed_session_is_the_session(regressor, actions):
    session = Session(regressor)
    for action, *arguments in actions:
        getattr(session, action)(*arguments)
    again = Session.loads(session.dumps(), regressor)
    assert again.events == session.events
    assert again.sketch == session.sketch
    assert [s.points.tobytes() for s in again.sketch.segments] == [s.points.tobytes() for s in session.sketch.segments]
    assert (again.can_undo, again.can_redo) == (session.can_undo, session.can_redo)
    while session.undo():
        again.undo()
        assert again.sketch == session.sketch
    assert session.sketch == Sketch()


def test_a_session_is_saved_and_loaded(session, regressor, tmp_path):
    session.draw(STROKE)
    session.save(tmp_path / "face.jsonl")
    session.draw(STROKE)
    session.save(tmp_path / "face.jsonl")
    again = Session.load(tmp_path / "face.jsonl", regressor)
    assert again.events == session.events
    assert list(tmp_path.iterdir()) == [tmp_path / "face.jsonl"]


def test_a_file_that_is_no_session_is_an_error(tmp_path, regressor, monkeypatch):
    path = tmp_path / "face.jsonl"
    with pytest.raises(FileNotFoundError):
        Session.load(path, regressor)
    path.write_bytes(b"\x89PNG\r\n\x1a\n\xff")
    with pytest.raises(SessionFileError, match=r"face\.jsonl is no session: not text"):
        Session.load(path, regressor)
    monkeypatch.setattr(textfile, "MAX_BYTES", 4)
    with pytest.raises(SessionFileError, match="larger than"):
        Session.load(path, regressor)
    assert regressor.asked == 0


def test_a_session_is_imported_without_torch_and_widgets():
    program = "import sys, sketchwidget.session as s; s.Session(); print({'torch', 'ipywidgets'} & sys.modules.keys())"
    output = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert output.strip() == "set()"


def test_a_file_that_is_no_session_is_named(tmp_path):
    (tmp_path / "letter.txt").write_text("Dear reader")
    with pytest.raises(SessionFileError, match=r"letter\.txt: line 1"):
        Session.load(tmp_path / "letter.txt")


def test_a_session_does_the_events_of_another_one_by_one(session):
    original = Session(inference=False)
    piece = original.sketch.lines["left_brow"][0]
    original.erase(piece[len(piece) // 2])
    original.draw(piece - [0, 0.02])
    original.undo()
    original.redo()

    copy = Session(inference=False)
    did = [copy.do(event) for event in original.events]
    assert did == [False, True, True, True, True]  # it had started from the template already
    assert np.array_equal(copy.face.vertices, original.face.vertices)
    with pytest.raises(TypeError, match="given dict"):
        copy.do(original.events[-1].to_json())


def test_a_session_infers_by_what_can_infer():
    with pytest.raises(TypeError, match=r"has infer\(sketch\), such as a FaceRegressor; given 'PixelCNN'"):
        Session("PixelCNN")
