from __future__ import annotations

from pathlib import Path

import ipycanvas.canvas
import numpy as np
import pytest

from sketchwidget.sketch import Sketch
from sketchwidget.widgets import pad as module
from sketchwidget.widgets.pad import INVITATION, OPEN_END_COLOUR, Pad

LINE = [(0.1, 0.1), (0.9, 0.9)]


@pytest.fixture
def commands(monkeypatch):
    """Record the batches of drawing commands that ipycanvas sends."""
    batches = []
    manager = ipycanvas.canvas._CANVAS_MANAGER
    monkeypatch.setattr(manager, "_send_custom", lambda command, buffers=(): batches.append((command, list(buffers))))
    return batches


def points_drawn(batches):
    return [np.frombuffer(buffer, dtype=np.float32) for _, buffers in batches for buffer in buffers]


def test_an_empty_pad_invites_and_a_drawn_one_does_not():
    pad = Pad()
    assert pad.widget.invitation == INVITATION
    pad.show(Sketch(()).with_segment("unnamed", LINE))
    assert pad.widget.invitation == ""
    pad.show(Sketch(()))
    assert pad.widget.invitation == INVITATION


def test_a_drawing_is_one_message(commands):
    Pad().show(Sketch(()).with_segment("silhouette", LINE).with_segment("nose", LINE))
    assert len(commands) == 1


def test_lines_are_drawn_at_the_size_of_the_canvas(commands):
    pad = Pad()
    pad.show(Sketch(()).with_segment("silhouette", LINE))
    commands.clear()
    pad.canvas.set_state({"width": 1000, "height": 1000})
    assert all(layer.width == layer.height == 1000 for layer in (pad.canvas[0], pad.canvas[1], pad.canvas[2]))
    drawn = next(points for points in points_drawn(commands) if len(points) == 4)
    np.testing.assert_allclose(drawn, [100, 100, 900, 900], rtol=1e-6)


def test_a_page_that_connects_gets_the_drawing(commands):
    pad = Pad()
    pad.show(Sketch(()).with_segment("silhouette", LINE))
    commands.clear()
    pad.canvas._handle_custom_msg({"event": "client_ready"}, [])
    assert any(len(points) == 4 for points in points_drawn(commands))


def test_a_dot_is_drawn(commands):
    Pad().show(Sketch(()).with_segment("unnamed", [(0.5, 0.5)]))
    names = [command[0] for batch, _ in commands for command in batch]
    assert ipycanvas.canvas.COMMANDS["fillCircle"] in names


def test_a_failure_while_drawing_does_not_hold_later_drawings(commands, monkeypatch):
    pad = Pad()
    sketch = Sketch(()).with_segment("silhouette", LINE)
    with monkeypatch.context() as broken:
        broken.setattr(ipycanvas.Canvas, "stroke_line_segments", lambda *_: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            pad.show(sketch)
    commands.clear()
    pad.show(sketch)
    assert len(commands) == 1


def test_open_ends_have_the_colour_of_the_other_marks():
    theme = Path(module.__file__).with_name("theme.css").read_text(encoding="utf-8")
    assert f"--sw-mark: {OPEN_END_COLOUR};" in theme
