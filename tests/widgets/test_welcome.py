"""What an empty Studio offers, and what it says is next."""

import numpy as np
import pytest

from sketchwidget.face import FaceModel
from sketchwidget.gesture.shapes import example as stroke_of
from sketchwidget.session import Session
from sketchwidget.widgets import Studio
from sketchwidget.widgets.status import missing
from sketchwidget.widgets.welcome import EXAMPLES, beyond, example


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_is_a_whole_face(name):
    session = Session.loads(example(name))
    assert not missing(session.sketch)
    assert np.abs(session.face.vertices - FaceModel.load().mean).max() > 2  # mm


def test_an_empty_studio_offers_drawings_and_one_click_loads_one():
    studio = Studio()
    _, *buttons = studio._welcome.children
    assert studio._welcome.layout.display is None and len(buttons) == len(EXAMPLES) == 3
    buttons[0].click()
    assert len(studio.session.sketch) and studio._welcome.layout.display == "none"
    assert studio._status.message.startswith("A laugh is loaded; undo brings the former drawing back.")
    assert "F edits the head's own lines." in studio._status.message
    studio._on_undo()
    assert not len(studio.session.sketch) and studio._welcome.layout.display is None


def test_each_mode_names_the_next_until_it_was_there():
    session = Session.loads(example("scowl"))
    assert beyond(Session()) == ""
    assert beyond(session) == "F edits the head's own lines."
    session.mode = "followup"
    assert beyond(session) == ""
    piece = session.sketch.lines["nose"][0]
    session.erase(piece[len(piece) // 2])
    assert beyond(session) == ""  # first the line has to be drawn anew
    session.draw(session.gap.erased.points + np.float32([0, 0.005]))
    assert beyond(session) == "R shapes the head by gestures."
    session.mode = "initial"
    assert beyond(session) == ""  # it has been there
    session.mode = "refine"
    chin = session.frame.project(session.face.landmarks[8])
    session.brush(session.under_brush([chin - [0, 0.03]], 0.03))
    assert beyond(session) == ""
    session.gesture(stroke_of("up roll 1", chin, 0.2))
    assert beyond(session) == "S saves the session, B exports the head."
