"""The collector's half in the kernel, with heads of the shipped model."""

from __future__ import annotations

import subprocess
import sys
from itertools import islice, repeat

import numpy as np
import pytest

from sketchwidget.database.drawings import read_drawings
from sketchwidget.face import Face
from sketchwidget.widgets import DrawingCollector
from sketchwidget.widgets.collector import random_faces

STROKE = np.array([[0.2, 0.5, 0.5, 0], [0.5, 0.5, 0.75, 100], [0.8, 0.5, 0.5, 200]], dtype="<f4")


@pytest.fixture(scope="module")
def faces(model):
    return list(islice(random_faces(model, 1), 3))


@pytest.fixture
def path(tmp_path):
    return tmp_path / "pupil.jsonl"


@pytest.fixture
def collector(path, faces):
    return DrawingCollector(path, faces)


def stroke(collector, points=STROKE, tool=0):
    """What the page sends of a stroke."""
    message = {"type": "stroke", "stroke": "a-0", "tool": tool, "mirror": False}
    collector._pad.widget._handle_custom_msg(message, [memoryview(np.asarray(points, dtype="<f4").tobytes())])


def keep(collector):
    stroke(collector)
    collector._keep.click()


def useful(button):
    return "sketchwidget-idle" not in button._dom_classes


def test_a_drawing_is_in_the_file_as_soon_as_it_is_kept(collector, path, faces, model):
    assert read_drawings(path) == []
    keep(collector)
    [drawing] = read_drawings(path)
    np.testing.assert_allclose(drawing.strokes[0], STROKE, atol=1e-6)
    np.testing.assert_array_equal(drawing.identity, faces[0].identity)
    np.testing.assert_array_equal(drawing.expression, faces[0].expression)
    assert (drawing.view, drawing.model) == ("front", model.fingerprint)
    assert collector._counter.value == "1 drawing kept"
    assert collector._status.message == "Kept in pupil.jsonl. Draw the head as you see it, or skip it."


def test_each_head_is_shown_in_turn(collector, faces, path, sent):
    messages = sent(collector._head.widget)
    collector._head.widget._handle_custom_msg({"type": "ready"}, [])
    keep(collector)
    collector._skip.click()
    shown = [np.frombuffer(buffers[0], dtype="<f4").reshape(-1, 3) for _, buffers in messages]
    assert len(shown) == 3
    for vertices, face in zip(shown, faces, strict=True):
        np.testing.assert_array_equal(vertices, face.vertices)
    keep(collector)
    np.testing.assert_array_equal(read_drawings(path)[1].identity, faces[2].identity)


def test_the_pad_is_empty_for_the_next_head(collector):
    keep(collector)
    assert len(collector._pad._sketch) == 0
    stroke(collector)
    collector._skip.click()
    assert len(collector._pad._sketch) == 0


def test_a_head_from_its_side_is_drawn_as_such(path, faces):
    collector = DrawingCollector(path, faces, view="left")
    assert collector._head.widget.renderer.camera.position == pytest.approx((1000, 0, 0))
    keep(collector)
    assert read_drawings(path)[0].view == "left"


def test_the_head_stays_in_its_view(collector):
    controls = collector._head.widget.renderer.controls[0]
    assert not (controls.enableRotate or controls.enablePan or controls.enableKeys)
    assert controls.minZoom == controls.maxZoom == 1


def test_an_empty_pad_is_not_kept(collector, path):
    collector._keep.click()
    assert read_drawings(path) == [] and collector._status.message.startswith("Nothing is drawn yet.")


def test_what_is_kept_is_what_is_left_after_erasing_and_undoing(collector, path):
    stroke(collector)
    stroke(collector, STROKE - [0, 0.2, 0, 0])
    collector._undo.click()
    stroke(collector, [[0.5, 0.4, 0.5, 0], [0.5, 0.6, 0.5, 9]], tool=1)
    assert collector._status.message.startswith("Erased.")
    stroke(collector, [[0.1, 0.1, 0.5, 0]], tool=1)
    assert collector._status.message.startswith("Nothing to erase there.")
    collector._keep.click()
    [drawing] = read_drawings(path)
    left, right = drawing.strokes
    assert left[-1] == pytest.approx([0.48, 0.5, 0.733, 93.3], abs=1e-3)
    assert right[0] == pytest.approx([0.52, 0.5, 0.733, 106.7], abs=1e-3)


def test_undo_takes_a_kept_drawing_back_once(collector, path, faces):
    keep(collector)
    keep(collector)
    collector._undo.click()
    assert len(read_drawings(path)) == 1 and len(collector._pad._sketch) == 1
    assert collector._counter.value == "1 drawing kept" and "kept no more" in collector._status.message
    collector._undo.click()
    collector._undo.click()
    assert len(read_drawings(path)) == 1 and collector._status.message.startswith("Nothing to undo.")
    collector._redo.click()
    collector._keep.click()
    np.testing.assert_array_equal(read_drawings(path)[1].identity, faces[1].identity)
    keep(collector)
    np.testing.assert_array_equal(read_drawings(path)[2].identity, faces[2].identity)


def test_undo_brings_a_skipped_head_back(collector, path, faces):
    collector._skip.click()
    collector._undo.click()
    keep(collector)
    np.testing.assert_array_equal(read_drawings(path)[0].identity, faces[0].identity)


def test_undo_does_not_take_a_drawing_back_once_something_was_drawn(collector, path):
    keep(collector)
    stroke(collector)
    for _ in range(3):
        collector._undo.click()
    assert len(read_drawings(path)) == 1 and useful(collector._redo)


def test_clearing_can_be_undone(collector):
    stroke(collector)
    collector._clear.click()
    assert len(collector._pad._sketch) == 0 and not useful(collector._keep)
    collector._undo.click()
    assert len(collector._pad._sketch) == 1 and useful(collector._keep)


def test_the_last_head_is_followed_by_none(collector, path):
    for _ in range(3):
        keep(collector)
    assert collector._status.message == "Kept in pupil.jsonl. There are no more heads. 3 drawings kept in pupil.jsonl."
    assert collector._pad.widget.invitation == "There are no more heads"
    assert not useful(collector._skip)
    keep(collector)
    collector._skip.click()
    assert len(read_drawings(path)) == 3
    collector._clear.click()


def test_opened_again_it_goes_on_with_what_is_not_drawn(collector, path, faces):
    keep(collector)
    collector._skip.click()
    keep(collector)
    again = DrawingCollector(path, faces)
    assert again._counter.value == "2 drawings kept"
    assert again._face is faces[1]
    keep(again)
    finished = DrawingCollector(path, faces)
    assert finished._face is None and "There are no more heads" in finished._status.message
    assert DrawingCollector(path, faces, view="left")._face is faces[0]


def test_one_head_can_be_drawn_again_and_again(path, faces):
    for kept in range(3):
        collector = DrawingCollector(path, repeat(faces[0]))
        assert len(read_drawings(path)) == kept
        keep(collector)


def test_random_heads_depend_on_the_seed(model, path, tmp_path):
    faces = [next(random_faces(model, seed)) for seed in (0, 0, 1)]
    np.testing.assert_array_equal(faces[0].vertices, faces[1].vertices)
    assert (faces[0].identity != faces[2].identity).any()
    assert (model.bilinear.identities == faces[0].identity).all(axis=1).any()
    assert (model.bilinear.expressions == faces[0].expression).all(axis=1).any()
    collector = DrawingCollector(path)
    np.testing.assert_array_equal(collector._face.vertices, faces[0].vertices)


def test_a_file_of_something_else_is_refused_and_left_alone(path, faces):
    path.write_text("Dear reader\n")
    with pytest.raises(ValueError, match=r"pupil\.jsonl holds no drawings"):
        DrawingCollector(path, faces)
    assert path.read_text() == "Dear reader\n"


def test_a_folder_that_is_missing_is_told_before_anything_is_drawn(tmp_path, faces):
    with pytest.raises(FileNotFoundError):
        DrawingCollector(tmp_path / "class" / "pupil.jsonl", faces)


def test_what_cannot_be_drawn_is_refused(path, model, faces):
    with pytest.raises(ValueError, match="no faces"):
        DrawingCollector(path, [])
    with pytest.raises(ValueError, match="this face has none"):
        DrawingCollector(path, [Face(model, model.mean)])
    with pytest.raises(ValueError, match="front or left; given 'right'"):
        DrawingCollector(path, faces, view="right")


def test_a_drawing_that_cannot_be_written_stays_on_the_pad(collector, path):
    keep(collector)
    text = path.read_text()
    path.write_text("Dear reader\n")
    keep(collector)
    assert collector._status.message.startswith("The drawing is not kept, it is still on the pad: ")
    assert len(collector._pad._sketch) == 1
    path.write_text(text)
    collector._keep.click()
    assert len(read_drawings(path)) == 2


def test_a_stroke_that_is_none_is_a_sentence(collector):
    stroke(collector, [[0.5, 50.0, 0.5, 0]])
    assert collector._status.message.startswith("This stroke cannot be drawn: ")


def test_faces_that_fail_are_a_sentence_and_the_drawing_is_kept(path, faces):
    def failing():
        yield faces[0]
        raise RuntimeError("the disk of heads is gone")

    collector = DrawingCollector(path, failing())
    keep(collector)
    assert len(read_drawings(path)) == 1 and len(collector._pad._sketch) == 0
    assert collector._status.message == "The next head cannot be shown: The disk of heads is gone."


def test_the_repr_is_short(collector):
    assert "No drawings kept" in repr(collector)


def test_the_collector_needs_no_network():
    code = (
        "import sys, tempfile, sketchwidget as sw;"
        "sw.DrawingCollector(tempfile.mkdtemp() + '/a.jsonl'); sys.exit('torch' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
