"""The Studio's half in the kernel, with a regressor that answers at once."""

from __future__ import annotations

import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from sketchwidget.face import FaceModel
from sketchwidget.geometry import View
from sketchwidget.session import Session
from sketchwidget.widgets import Studio, studio

OVAL = [(0.3, 0.5), (0.5, 0.1), (0.7, 0.5), (0.5, 0.9), (0.3, 0.5)]


class FakeRegressor:
    """Each stroke makes the head wider; the first is the outline."""

    broken = False

    def __init__(self, face):
        self.face = face

    def infer(self, sketch):
        if self.broken:
            raise RuntimeError("the weights are gone")
        names = tuple("silhouette" if number == 0 else "nose" for number in range(len(sketch)))
        return SimpleNamespace(face=self.face(50.0 + len(sketch)), frame=View(), names=names, timings={})


@pytest.fixture
def regressor(face):
    return FakeRegressor(type(face))


@pytest.fixture
def shown(regressor, face, monkeypatch):
    monkeypatch.setattr(studio, "FaceModel", SimpleNamespace(load=lambda: SimpleNamespace(face=lambda: face)))
    return Studio(Session(regressor))


def stroke(shown, points=OVAL, tool="pen", mirror=False):
    points = np.column_stack([np.asarray(points, dtype=np.float32), np.zeros((len(points), 2), dtype=np.float32)])
    shown._drawing._on_stroke(points, tool, mirror)


def test_a_stroke_is_drawn_and_the_head_follows(shown, sent):
    messages = sent(shown._head.widget)
    stroke(shown)
    assert list(shown.session.sketch.lines) == ["silhouette"]
    (_, buffers), *more = messages
    assert not more and np.frombuffer(buffers[0], dtype="<f4").max() == 100.0
    assert np.frombuffer(buffers[0], dtype="<f4").min() == -51.0
    assert shown._status.message == "Stroke drawn. Still to draw: eyes, brows, nose and mouth, in any order."


def test_a_script_draws_and_the_studio_shows_it(shown, sent):
    messages = sent(shown._head.widget)
    shown.session.draw(OVAL)
    assert len(messages) == 1 and shown._drawing.pad.widget.invitation == ""


def test_the_first_face_is_not_inferred(shown):
    assert not shown.session.trait_has_value("face")


def test_a_notebook_that_is_opened_without_its_kernel_says_how_to_see_the_studio(shown):
    shown_in_notebook = shown._repr_mimebundle_()
    assert "Shift+Enter" in shown_in_notebook["text/plain"]
    assert shown_in_notebook["application/vnd.jupyter.widget-view+json"]["model_id"] == shown.model_id


def test_tools_and_mirror(shown):
    stroke(shown, mirror=True)
    assert len(shown.session.sketch) == 2
    stroke(shown, points=[(0.3, 0.4), (0.3, 0.6), (0.7, 0.6), (0.7, 0.4)], tool="eraser")
    assert shown._status.message.startswith("Erased.")
    stroke(shown, points=[(0.01, 0.01)], tool="eraser")
    assert shown._status.message.startswith("Nothing to erase there.")


def test_buttons_show_what_would_do_something(shown):
    def useful(button):
        return "sketchwidget-idle" not in button._dom_classes

    assert not any(useful(button) for button in (shown._undo, shown._redo, shown._clear))
    stroke(shown)
    assert useful(shown._undo) and useful(shown._clear) and not useful(shown._redo)
    shown._undo.click()
    assert useful(shown._redo) and not useful(shown._undo) and not useful(shown._clear)
    shown._undo.click()
    assert shown._status.message.startswith("Nothing to undo.")


def test_a_failing_network_is_a_sentence_and_keeps_the_drawing(shown, regressor):
    regressor.broken = True
    stroke(shown)
    assert len(shown.session.sketch) == 1
    expected = "The head could not follow this stroke, the drawing is kept: The weights are gone."
    assert shown._status.message == expected
    regressor.broken = False
    stroke(shown)
    assert len(shown.session.sketch) == 2 and shown._status.message.startswith("Stroke drawn.")


def test_a_stroke_that_is_none_is_refused(shown):
    stroke(shown)
    stroke(shown, points=[(0.5, 50.0), (0.1, 0.1)])
    assert len(shown.session.sketch) == 1 and "drawing is kept" in shown._status.message


def load(shown, name, content):
    shown._files._on_load(
        {"new": (SimpleNamespace(name=name, content=memoryview(content)),), "owner": SimpleNamespace()}
    )


def test_loading_replaces_the_session_and_can_be_undone(shown):
    stroke(shown)
    text = shown.session.dumps()
    shown._clear.click()
    former = shown.session
    load(shown, "drawing.jsonl", text.encode())
    assert shown.session is not former and len(shown.session.sketch) == 1
    shown._undo.click()
    assert shown.session is former and len(shown.session.sketch) == 0


def test_after_a_stroke_on_a_loaded_session_undo_takes_the_stroke(shown):
    stroke(shown)
    load(shown, "drawing.jsonl", shown.session.dumps().encode())
    loaded = shown.session
    stroke(shown)
    shown._undo.click()
    assert shown.session is loaded and len(loaded.sketch) == 1


@pytest.mark.parametrize("content", [b"", b"Dear reader\n", b"\xff\xfe\x00", b'{"format": "sketchwidget session"'])
def test_a_bad_file_is_a_sentence_and_keeps_the_drawing(shown, content):
    stroke(shown)
    session = shown.session
    load(shown, "letter.txt", content)
    assert shown.session is session and len(session.sketch) == 1
    assert shown._status.message.startswith("letter.txt was not loaded, the drawing is kept: ")


def test_the_ghost_is_the_heads_own_drawing(shown):
    shown._drawing._ghost.value = True
    assert shown._drawing.pad._ghost is not None and len(shown._drawing.pad._ghost) == 1
    assert shown._status.message.startswith("The head's own lines lie under the ink. ")
    shown._drawing._ghost.value = False
    assert shown._drawing.pad._ghost is None


def test_another_session_is_shown_and_the_former_let_go(shown, regressor, sent):
    former = shown.session
    shown.session = Session(regressor)
    messages = sent(shown._head.widget)
    former.draw(OVAL)
    assert messages == []
    shown.session.draw(OVAL)
    assert len(messages) == 1


def test_the_mode_is_named(shown):
    assert shown._mode.value == "initial" and shown._status._figures.value.startswith("Initial")


def test_the_repr_is_short(shown):
    assert len(repr(shown)) < 100


def test_studio_does_not_import_torch_before_it_is_on_a_page():
    code = "import sys, sketchwidget as sw; sw.Studio(); sys.exit('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_change_is_drawn_once(shown, monkeypatch):
    drawings = []
    monkeypatch.setattr(shown._drawing.pad, "show", lambda *drawing, **options: drawings.append(drawing))
    shown.session.draw(OVAL)
    shown.session.undo()
    assert len(drawings) == 2


def partial(shown, points=OVAL, mirror=False):
    points = np.column_stack([np.asarray(points, dtype=np.float32), np.zeros((len(points), 2), dtype=np.float32)])
    shown._drawing._on_partial(points, mirror)


def test_the_head_follows_a_stroke_that_is_still_being_drawn(shown, sent):
    messages = sent(shown._head.widget)
    shown.session.draw(OVAL)
    partial(shown, [(0.4, 0.5), (0.6, 0.5)])
    assert len(messages) == 2 and len(shown.session.sketch) == 1 and len(shown.session.events) == 1
    stroke(shown, [(0.4, 0.5), (0.6, 0.52)])
    assert len(messages) == 3 and len(shown.session.sketch) == 2


def test_a_stroke_that_comes_to_nothing_gives_the_head_back(shown, sent):
    messages = sent(shown._head.widget)
    shown.session.draw(OVAL)
    partial(shown)
    shown._drawing.pad.widget._handle_custom_msg({"type": "cancelled"}, [])
    np.testing.assert_array_equal(*(np.frombuffer(messages[k][1][0], dtype="<f4") for k in (0, -1)))
    partial(shown)
    stroke(shown, [(np.nan, 0.5), (0.6, 0.5)])
    np.testing.assert_array_equal(*(np.frombuffer(messages[k][1][0], dtype="<f4") for k in (0, -1)))
    assert "kept" in shown._status.message


def test_what_is_no_stroke_yet_says_nothing(shown):
    said = shown._status.message
    partial(shown, [(np.nan, 0.5), (0.6, 0.5)])
    assert shown._status.message == said


def test_the_tabs_are_the_modes(shown):
    shown._mode.value = "followup"
    assert "could not be changed" in shown._status.message  # this regressor's faces have no lines
    assert shown.session.mode == shown._mode.value == "initial"


class TestFollowUp:
    """On the shipped face model, without inference."""

    @pytest.fixture(scope="class")
    def model_only(self):
        return SimpleNamespace(model=FaceModel.load())

    @pytest.fixture
    def shown(self, model_only):
        return Studio(Session(model_only, inference=False))

    def erase_brow(self, shown):
        points = shown.session.sketch.lines["left_brow"][0]
        stroke(shown, points=[points[3]], tool="eraser")
        return points

    def test_the_lines_of_the_template_are_shown(self, shown):
        assert shown._mode.value == "followup" and "left_brow" in shown._drawing.pad._sketch.lines
        assert shown._status.message.startswith("Erase a piece of a line")
        assert shown._status._figures.value.startswith("Follow-up")

    def test_an_erased_piece_waits_and_says_so(self, shown):
        assert len(shown._drawing.pad.widget.pieces) == len(shown.session.sketch) - 1
        outline = shown.session.sketch.lines["silhouette"][0]
        np.testing.assert_allclose(np.reshape(shown._drawing.pad.widget.outline, (-1, 2)), outline, atol=1e-4)
        self.erase_brow(shown)
        assert shown._drawing.pad.widget.outline == []
        assert shown._drawing.pad._gap is shown.session.gap is not None
        assert shown._status.message.startswith("Erased. Now draw the left brow anew from the marked end")
        assert len(shown._drawing.pad.widget.pieces) == len(shown.session.sketch.lines["left_brow"])
        stroke(shown, points=[shown.session.sketch.lines["nose"][0][3]], tool="eraser")
        assert shown._status.message.startswith("What was erased comes first.")
        shown._drawing._cancel.click()
        assert shown.session.gap is None and shown._status.message.startswith("It is as it was.")

    def test_the_replacement_moves_the_head(self, shown, sent):
        messages = sent(shown._head.widget)
        points = self.erase_brow(shown)
        before = shown.session.sketch
        partial(shown, points[:3] - np.array([0, 0.03]))
        assert len(messages) == 1 and shown.session.sketch is before
        stroke(shown, points=points - np.array([0, 0.03]))
        assert len(messages) == 2 and shown._status.message.startswith("The left brow is drawn anew.")

    def test_a_stroke_that_closes_no_gap_is_a_sentence(self, shown):
        self.erase_brow(shown)
        stroke(shown, points=[(0.1, 0.1)])
        assert "the drawing is kept: A dot closes no gap" in shown._status.message and shown.session.gap is not None

    def test_in_a_side_view_the_profile_is_dragged(self, shown):
        shown._on_view("left")
        assert list(shown._drawing.pad._sketch.lines) == ["silhouette"]
        before = shown.session.face
        line = shown.session.profile("left")
        stroke(shown, points=line[50:70] - np.array([0.02, 0]))
        assert shown.session.face is not before and shown._status.message.startswith("The profile follows.")
        shown._on_view("front")
        assert "left_brow" in shown._drawing.pad._sketch.lines

    def test_a_gap_that_undo_opens_is_seen_from_the_front_where_it_can_be_closed(self, shown, sent):
        points = self.erase_brow(shown)
        stroke(shown, points=points - np.array([0, 0.03]))
        shown._on_view("left")
        messages = sent(shown._head.widget)
        shown._undo.click()
        assert shown.session.gap is not None and "left_brow" in shown._drawing.pad._sketch.lines
        assert [content["direction"] for content, _ in messages if content["type"] == "look"] == [[0, 0, 1]]
        assert "Now draw the left brow anew" in shown._status.message
        stroke(shown, points=points - np.array([0, 0.03]))
        assert shown.session.gap is None and shown._status.message.startswith("The left brow is drawn anew.")

    def test_the_pad_is_seen_from_the_front_again_as_the_head_is_after_a_tab_of_pictures(self, shown):
        shown._on_view("left")
        shown._mode.value = "caricature"
        shown._mode.value = "followup"
        assert "left_brow" in shown._drawing.pad._sketch.lines

    def test_the_template_button_starts_anew(self, shown):
        points = self.erase_brow(shown)
        stroke(shown, points=points - np.array([0, 0.03]))
        shown._on_template()
        np.testing.assert_array_equal(shown.session.face.vertices, shown.session.face.model.mean)
        shown._undo.click()
        assert shown.session.face.vertices[:, 1].max() != 0 and not np.array_equal(
            shown.session.face.vertices, shown.session.face.model.mean
        )

    def test_a_loaded_session_infers_as_the_former_one(self, shown):
        load(shown, "drawing.jsonl", shown.session.dumps().encode())
        assert shown.session.mode == "followup" and not shown.session.inference


def test_what_is_no_session_is_not_shown():
    with pytest.raises(TypeError, match="a Studio shows a Session; given 'face'"):
        Studio("face")
