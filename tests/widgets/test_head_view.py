from __future__ import annotations

import numpy as np
import pytest

from sketchwidget.geometry import View
from sketchwidget.widgets.head_view import HeadView


def test_a_page_that_is_ready_gets_the_face(face, sent):
    head = HeadView(face)
    messages = sent(head.widget)
    head.widget._handle_custom_msg({"type": "ready"}, [])
    (content, buffers), *more = messages
    assert not more
    assert (content["type"], content["scale"], content["centre"]) == ("mesh", pytest.approx(1 / 250), [0.5, 0.5])
    np.testing.assert_array_equal(np.frombuffer(buffers[0], dtype="<f4").reshape(-1, 3), face.vertices)


def test_a_face_is_sent_once(face, sent):
    head, frame = HeadView(face), View()
    messages = sent(head.widget)
    other = type(face)(60.0)
    head.show(other, frame)
    head.show(other, frame)
    assert [content["serial"] for content, _ in messages] == [1]
    head.show(other, View(centre=np.array([0.4, 0.5])))
    assert messages[-1][0]["centre"] == pytest.approx([0.4, 0.5])


@pytest.mark.parametrize(("preset", "direction"), [("front", (0, 0, 1)), ("left", (1, 0, 0)), ("right", (-1, 0, 0))])
def test_presets_look_from_where_they_say(face, sent, preset, direction):
    head = HeadView(face)
    messages = sent(head.widget)
    head.look(preset)
    assert messages[0][0]["direction"] == pytest.approx(direction, abs=1e-6)


def test_lights_shine_at_the_heads_origin_from_the_camera(face):
    head = HeadView(face)
    camera = head.widget.renderer.camera
    assert len(camera.children) == 3 and camera in head.widget.renderer.scene.children
