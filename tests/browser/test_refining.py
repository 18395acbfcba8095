"""Gestures on the head of a Studio, with a mouse in a real browser."""

import numpy as np
import pytest
from refining import drawn, stroke
from studio_page import until

from sketchwidget import FaceModel, View

NOSE, CHIN = 30, 8
CODE = "studio = sw.Studio(sw.Session(inference=False))\nstudio"


@pytest.fixture(scope="module")
def studio(open_studio):
    studio = open_studio("lab", code=CODE)
    studio.press("r")
    until(lambda: "sketchwidget-refining" in (studio.head.get_attribute("class") or ""), what="the refinement mode")
    return studio


@pytest.fixture(scope="module")
def model():
    return FaceModel.load()


def flash(studio):
    """What flashes now, read without waiting: a flash may end at any moment."""
    return "".join(studio.head.locator(".sketchwidget-flash:not([hidden])").all_inner_texts())


def act(studio, key, points, said):
    """Draw with a tool; wait until its effect flashes by the pointer."""
    until(lambda: flash(studio), lambda text: not text, "no flash of before")
    studio.press(key)
    until(lambda: flash(studio), lambda text: not text)
    studio.draw_on_head(points)
    return until(lambda: flash(studio), lambda text: said in text, f"a flash of {said!r}")


def test_a_face_is_refined_on_the_page(studio, model):
    def seen(landmark):
        return View().project(studio.positions()[model.landmarks[landmark]])

    start = studio.positions()
    tip = model.landmarks[NOSE]

    # The nose tip is brushed, an up roll brings it forward, a left arrow takes it back.
    act(studio, "h", stroke(seen(NOSE), seen(NOSE) + 0.005), "handles marked")
    act(studio, "d", drawn("up roll 3", seen(NOSE), 0.2), "up roll 3")
    until(lambda: studio.positions()[tip, 2] - start[tip, 2], lambda forward: forward > 10, "a nose that came forward")
    act(studio, "d", drawn("left arrow", seen(NOSE), 0.2), "left arrow")
    until(lambda: np.abs(studio.positions() - start).max(), lambda moved: moved < 1e-3, "the nose of before")

    # A region round the chin, handles on it, a line down: only the chin moves.
    middle = seen(CHIN) - np.array([0, 0.04])
    act(studio, "d", drawn("region", middle, 0.3), "region")
    act(studio, "u", stroke(seen(NOSE) - 0.03, seen(NOSE) + 0.03), "marked")
    act(
        studio, "h", stroke(seen(CHIN) - np.array([0.01, 0.02]), seen(CHIN) + np.array([0.01, -0.02])), "handles marked"
    )
    act(studio, "d", stroke(seen(CHIN) - np.array([0, 0.03]), seen(CHIN) + np.array([0, 0.03])), "line")
    moved = until(
        lambda: np.linalg.norm(studio.positions() - start, axis=1), lambda moved: moved.max() > 10, "a longer chin"
    )
    assert (start[moved > 0.01, 1] < start[model.landmarks[33], 1]).all()  # nothing above the foot of the nose
    assert moved[model.landmarks[[17, 26, 30, 36, 45]]].max() == 0

    # What is none of the ten is told, and changes nothing.
    before = studio.positions()
    act(studio, "d", np.random.default_rng(0).random((20, 2)) * 0.5 + 0.25, "not a gesture")
    assert "Not a gesture" in studio.message
    np.testing.assert_array_equal(studio.positions(), before)


def test_the_right_button_turns_the_head_and_the_pen_does_not(studio):
    before = studio.camera()["direction"]
    studio.press("h")
    studio.draw_on_head(stroke([0.5, 0.5], [0.52, 0.5]))
    until(lambda: flash(studio))
    assert studio.camera()["direction"] == before
    studio.draw_on_head(stroke([0.5, 0.5], [0.7, 0.5]), button="right")
    turned = until(lambda: studio.camera()["direction"], lambda direction: direction != before, "a head that turned")
    assert abs(turned[0]) > 0.2 and abs(turned[1] - before[1]) < 0.05
