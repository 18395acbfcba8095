from __future__ import annotations

import numpy as np
import pytest
from ipycanvas import MultiCanvas

from sketchwidget.widgets.ink import Ink

STROKE = np.array([[0.1, 0.2, 0.5, 0], [0.3, 0.4, 0.5, 8]], dtype="<f4")


def message(tool: int = 0, mirror: bool = False) -> tuple[dict, list[memoryview]]:
    return {"type": "stroke", "stroke": "a-0", "tool": tool, "mirror": mirror}, [memoryview(STROKE.tobytes())]


@pytest.mark.parametrize(("tool", "name"), [(0, "pen"), (1, "eraser")])
def test_a_stroke_arrives_as_points(tool, name):
    ink, seen = Ink(canvas=MultiCanvas(3)), []
    ink.on_stroke(lambda *stroke: seen.append(stroke))
    ink._handle_custom_msg(*message(tool, mirror=True))
    points, seen_tool, mirror = seen[0]
    np.testing.assert_array_equal(points, STROKE)
    assert (seen_tool, mirror) == (name, True)


def test_the_ink_is_told_to_dry_after_the_stroke_was_dealt_with(sent):
    ink, order = Ink(canvas=MultiCanvas(3)), []
    messages = sent(ink)
    ink.on_stroke(lambda *_: order.append(len(messages)))
    ink._handle_custom_msg(*message())
    assert order == [0]
    assert messages == [({"type": "dry", "stroke": "a-0"}, None)]


def test_the_ink_dries_when_dealing_with_the_stroke_fails(sent):
    ink = Ink(canvas=MultiCanvas(3))
    messages = sent(ink)
    ink.on_stroke(lambda *_: 1 / 0)
    ink._handle_custom_msg(*message())
    assert messages == [({"type": "dry", "stroke": "a-0"}, None)]


def test_a_page_that_is_ready_is_heard():
    ink, heard = Ink(canvas=MultiCanvas(3)), []
    ink.on_ready(lambda: heard.append(True))
    ink._handle_custom_msg({"type": "ready"}, [])
    assert heard == [True]


def test_a_partial_stroke_is_answered_once_it_was_dealt_with(sent):
    ink, seen = Ink(canvas=MultiCanvas(3)), []
    messages = sent(ink)
    ink.on_partial(lambda points, mirror: seen.append((points, mirror, len(messages))))
    ink._handle_custom_msg({"type": "partial", "stroke": "a-1", "mirror": True}, [memoryview(STROKE.tobytes())])
    (points, mirror, before) = seen[0]
    np.testing.assert_array_equal(points, STROKE)
    assert mirror and before == 0 and messages == [({"type": "followed", "stroke": "a-1"}, None)]


def test_a_stroke_that_was_cancelled_is_heard():
    ink, heard = Ink(canvas=MultiCanvas(3)), []
    ink.on_cancel(lambda: heard.append(True))
    ink._handle_custom_msg({"type": "cancelled"}, [])
    assert heard == [True]
