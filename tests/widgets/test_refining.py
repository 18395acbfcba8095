"""The refinement mode of the Studio, without a page."""

import numpy as np
import pytest
from refining import about, drawn

from sketchwidget import GESTURES, Session, Studio, View, register_gesture
from sketchwidget.session import behaviours
from sketchwidget.widgets.refine_pad import TOOLS, RefinePad
from sketchwidget.widgets.refining import EFFECTS, border_of, chart

FRONT = View()


@pytest.fixture(scope="module")
def head():
    return Session(inference=False).face


@pytest.fixture
def studio():
    studio = Studio(Session(inference=False))
    studio.session.mode = "refine"
    return studio


def message(studio, points, tool="gesture", view=FRONT, kind="stroke"):
    """What a page sends for a stroke; what it is sent in answer."""
    pad, sent = studio._refining.pad, []
    pad.send = lambda content, buffers=None: sent.append(content)
    points = np.asarray(points, dtype="<f4")
    whole = np.concatenate([points, np.zeros((len(points), 2), dtype="<f4")], axis=1)
    seen = {"rotation": view.rotation.tolist(), "scale": view.scale, "centre": view.centre.tolist()}
    content = {"type": kind, "stroke": "a", "tool": pad.tools.index(tool), "view": seen}
    pad._handle_custom_msg(content, [memoryview(whole.tobytes())])
    return next(one for one in sent if one["type"] == "answer")


def nose(studio):
    return FRONT.project(studio.session.face.landmarks[30])


def test_the_tools_are_there_while_the_head_is_refined(studio):
    refining = studio._refining
    assert refining.pad.active and refining.bar.layout.display == ""
    studio.session.mode = "initial"
    assert not refining.pad.active and refining.bar.layout.display == "none"


def test_the_brush_marks_and_unmarks_what_it_touches(studio):
    middle = nose(studio)
    answer = message(studio, [middle, middle + 0.001], "brush")
    handles = studio.session.handles
    assert answer["good"] and answer["text"] == f"{len(handles)} handles marked"
    canvas = FRONT.project(studio.session.face.vertices)
    assert len(handles) and np.linalg.norm(canvas[handles] - middle, axis=1).max() < 0.022
    assert studio._refining.pad._marks[0].tolist() == handles.tolist()
    message(studio, [middle, middle + 0.001], "unbrush")
    assert not len(studio.session.handles)


def test_a_gesture_flashes_its_name_and_moves_the_head(studio):
    studio.session.brush(about(studio.session.face, 30, 6))
    before = studio.session.face.landmarks[30, 2]
    answer = message(studio, drawn("up roll 2", nose(studio)))
    assert answer["text"].startswith("up roll 2") and answer["good"]
    assert studio.session.face.landmarks[30, 2] > before + 5
    answer = message(studio, drawn("left arrow", nose(studio)))
    assert answer["text"] == "left arrow: undo"
    assert studio.session.face.landmarks[30, 2] == before
    message(studio, drawn("right arrow", nose(studio)))
    assert message(studio, drawn("right arrow", nose(studio)))["text"] == "right arrow: nothing to redo"
    assert studio._status.message.startswith("Right arrow: nothing to redo.")


def test_a_line_flashes_what_it_did(studio):
    cheek = [FRONT.project(studio.session.face.landmarks[at]) - np.array([0.01, 0]) for at in (2, 5)]
    assert message(studio, np.linspace(*cheek, 20))["text"] == "line: drags the outline"
    studio.session.brush(about(studio.session.face, 30, 6))
    line = np.linspace(nose(studio), nose(studio) + np.array([0, 0.04]), 20)
    assert message(studio, line)["text"] == "line: moves the handles"


def test_a_region_s_border_is_shown(studio):
    message(studio, drawn("region", nose(studio), 0.2))
    border = studio._refining.pad._marks[1]
    assert len(border) > 10 and np.isin(border, studio.session.region).all()


def test_what_fails_flashes_and_is_told_and_changes_nothing(studio):
    face, events = studio.session.face, studio.session.events
    answer = message(studio, np.random.default_rng(0).random((40, 2)))
    assert not answer["good"] and answer["text"] == "not a gesture"
    assert studio._status.message.startswith("Nothing was changed: Not a gesture")
    assert not message(studio, [[0.01, 0.01], [0.02, 0.01]], "brush")["good"]
    assert studio.session.face is face and studio.session.events == events


def test_a_gesture_is_followed_while_it_is_drawn(studio):
    studio.session.brush(about(studio.session.face, 30, 6))
    shown = []
    studio._head.show = lambda face, frame, passing=False: shown.append((face, passing))
    face = studio.session.face
    line = np.linspace(nose(studio), nose(studio) - np.array([0, 0.04]), 20)
    message(studio, line, kind="partial")
    (preview, passing), *_ = shown
    assert passing and preview.landmarks[30, 1] > face.landmarks[30, 1] + 9
    assert studio.session.face is face


def test_a_roll_is_not_first_followed_as_a_line(studio):
    studio.session.brush(about(studio.session.face, 30, 6))
    shown = []
    studio._head.show = lambda face, frame, passing=False: shown.append(face)
    rest = studio.session.face
    roll = drawn("up roll 2", nose(studio), 0.2)
    for count in range(8, len(roll), 4):
        shown.clear()
        message(studio, roll[:count], kind="partial")
        forward = [face.landmarks[30] - rest.landmarks[30] for face in shown]
        for across, up, depth in forward:
            assert np.hypot(across, up) < 5 and depth > -1e-3  # as a line, it would go 20 mm aside
    assert forward[-1][2] > 7


@pytest.fixture
def tools_restored():
    known = dict(behaviours._BEHAVIOURS)
    yield
    behaviours._BEHAVIOURS.clear()
    behaviours._BEHAVIOURS.update(known)


def test_a_tool_that_is_registered_has_a_button(studio, tools_restored):
    bar = studio._refining._tools
    bar.value = "brush"
    register_gesture("lift", lambda edit: edit.displaced(np.tile([0, 2.0, 0], (len(edit.face.vertices), 1))))
    register_gesture("zigzag", lambda edit: edit.refinement, lambda points: False)  # a gesture: no button
    studio.session.brush([5])
    assert [value for _, value in bar.options] == [*TOOLS, "lift"] and bar.value == "brush"
    before = studio.session.face
    answer = message(studio, np.random.default_rng(0).random((20, 2)), tool="lift")
    assert answer["good"] and answer["text"] == "lift"
    soft = before.model.template.fine_parts <= 1
    np.testing.assert_allclose((studio.session.face.vertices - before.vertices)[soft, 1], 2.0, atol=1e-3)
    again = Studio(Session(inference=False))
    again.session.mode = "refine"
    assert [value for _, value in again._refining._tools.options] == [*TOOLS, "lift"]


def test_the_border_of_two_triangles_is_their_outline():
    faces = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2]])
    region = np.array([True, True, True, True, False])
    assert sorted(sorted(edge) for edge in border_of(region, faces).tolist()) == [[0, 1], [0, 2], [1, 3], [2, 3]]
    assert border_of(np.zeros(5, dtype=bool), faces).shape == (0, 2)


def test_the_chart_shows_every_gesture():
    assert all(f"<figcaption>{name}</figcaption>" in chart() for name in GESTURES)


def test_there_are_words_for_what_every_gesture_does():
    assert set(EFFECTS) == set(GESTURES)


def test_the_chart_shows_a_gesture_that_has_no_words_yet(monkeypatch):
    monkeypatch.delitem(EFFECTS, "region")
    assert "<title>region</title>" in chart() and "<title>line: moves" in chart()


def test_a_message_of_no_kind_is_passed_over():
    RefinePad()._handle_custom_msg({"type": "else"}, [])
