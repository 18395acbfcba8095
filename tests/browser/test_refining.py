"""Gestures on the head of a Studio, with a mouse in a real browser."""

import numpy as np
import pytest
from refining import drawn, stroke
from studio_page import until

from sketchwidget import View

NOSE, CHIN = 30, 8
CODE = """
def lift(edit):
    import numpy as np
    return edit.displaced(np.tile([0, 5.0, 0], (len(edit.face.vertices), 1)))

studio = sw.Studio(sw.Session(inference=False))
sw.register_gesture("lift", lift)  # after the Studio was made
studio
"""
# What kinds of pointer the page has seen, and what flashed: a flash is gone soon.
SCRIPT = """
window.pointers = [];
window.flashes = [];
addEventListener('pointerdown', event => { pointers.push(event.pointerType); }, true);
new MutationObserver(changes => {
    for (const { target } of changes) {
        if (target.classList?.contains('sketchwidget-flash')) flashes.push(target.textContent);
    }
}).observe(document, { childList: true, subtree: true });
"""


@pytest.fixture(scope="module")
def studio(open_studio):
    studio = open_studio("lab", code=CODE, script=SCRIPT, has_touch=True)
    studio.press("r")
    until(lambda: "sketchwidget-refining" in (studio.head.get_attribute("class") or ""), what="the refinement mode")
    return studio


def flash(studio):
    """What flashed since this was emptied."""
    return " ".join(studio.page.evaluate("window.flashes"))


def act(studio, key, points, said, draw=None):
    """Draw with a tool; wait until its effect flashes by the pointer."""
    studio.press(key)
    studio.page.evaluate("window.flashes = []")
    (draw or studio.draw_on_head)(points)
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
    act(studio, "h", stroke([0.5, 0.5], [0.52, 0.5]), "andles")
    assert studio.camera()["direction"] == before
    studio.draw_on_head(stroke([0.5, 0.5], [0.7, 0.5]), button="right")
    turned = until(lambda: studio.camera()["direction"], lambda direction: direction != before, "a head that turned")
    assert abs(turned[0]) > 0.2 and abs(turned[1] - before[1]) < 0.05


def marks(studio):
    """How many pixels of the pad over the head have the colour of handles, which is that of marks in theme.css."""
    return studio.head.locator(".sketchwidget-marks").evaluate(
        """canvas => {
            const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
            let count = 0;
            for (let at = 0; at < data.length; at += 4) {
                count += [13, 131, 119, 255].every((value, channel) => Math.abs(data[at + channel] - value) < 3);
            }
            return count;
        }"""
    )


def start(studio):
    """The head from the front, without marks."""
    studio.press("1")
    until(studio.turning, lambda turning: not turning)
    if studio.is_useful("clear"):
        studio.click("clear")
    until(lambda: not studio.is_useful("clear"))


@pytest.mark.parametrize("kind", ["touch", "pen"])
def test_a_finger_and_a_pen_brush_and_draw_gestures_and_do_not_turn_the_head(studio, model, kind):
    start(studio)
    draw = studio.touch_head if kind == "touch" else studio.draw_on_head_with_pen
    tip, before, camera = model.landmarks[NOSE], studio.positions(), studio.camera()
    nose = View().project(before[tip])
    studio.page.evaluate("window.pointers = []")
    act(studio, "h", stroke(nose, nose + 0.005), "handles marked", draw)
    act(studio, "d", drawn("up roll 3", nose, 0.2), "up roll 3", draw)
    until(lambda: studio.positions()[tip, 2] - before[tip, 2], lambda forward: forward > 10, "a nose that came forward")
    act(studio, "d", drawn("left arrow", nose, 0.2), "left arrow", draw)
    until(lambda: np.abs(studio.positions() - before).max(), lambda moved: moved < 1e-3, "the nose of before")
    assert studio.page.evaluate("window.pointers") == [kind] * 3
    assert studio.camera() == camera


def hold(studio, points):
    """Draw with the mouse over the head, and keep the button down."""
    first, *others = studio._on_head(points)
    studio.page.mouse.move(**first)
    studio.page.mouse.down()
    for place in others:
        studio.page.mouse.move(**place)


def test_the_head_follows_a_gesture_up_to_where_the_pen_rests(studio, model):
    start(studio)
    before, tip = studio.positions(), model.landmarks[NOSE]
    nose = View().project(before[tip])
    act(studio, "h", stroke(nose, nose + 0.005), "handles marked")
    studio.press("d")
    way = np.array([0, 0.06])
    hold(studio, nose + np.linspace(0, 1, 30)[:, None] * way)
    far = way[1] / View().scale  # mm
    until(
        lambda: before[tip, 1] - studio.positions()[tip, 1], lambda down: abs(down - far) < 0.5, "a nose under the pen"
    )
    studio.page.evaluate("window.flashes = []")
    studio.page.mouse.up()
    until(lambda: flash(studio), lambda said: "line" in said, "the flash of the line")
    act(studio, "d", drawn("left arrow", nose, 0.2), "left arrow")
    until(lambda: np.abs(studio.positions() - before).max(), lambda moved: moved < 1e-3, "the nose of before")


def test_a_button_that_was_let_go_unseen_ends_the_stroke(studio, model):
    start(studio)
    nose = View().project(studio.positions()[model.landmarks[NOSE]])
    studio.press("h")
    studio.page.evaluate("window.flashes = []")
    hold(studio, [nose, nose + 0.01])
    (place,) = studio._on_head([nose + 0.02])
    screen = studio.page.context.new_cdp_session(studio.page)
    screen.send("Input.dispatchMouseEvent", {"type": "mouseMoved", "buttons": 0, **place})
    until(lambda: flash(studio), lambda said: "handles marked" in said, "the flash of the brush")
    screen.detach()
    studio.page.mouse.up()


def test_handles_that_the_head_hides_do_not_show_through(studio, model):
    start(studio)
    act(studio, "h", stroke(*[View().project(studio.positions()[model.landmarks[at]]) for at in (36, 31)]), "marked")
    seen = until(lambda: marks(studio), what="handles that show")
    studio.press("2")  # the subject's left side: the handles are beside the nose, on the right
    until(studio.turning, lambda turning: not turning)
    until(lambda: marks(studio), lambda count: count < 0.05 * seen, "hidden handles")
    studio.press("3")
    until(lambda: marks(studio), lambda count: count > 0.2 * seen, "handles that show again")


def test_a_tool_that_was_registered_has_a_button_and_does_what_it_does(studio, model):
    start(studio)
    before = studio.positions()[model.landmarks[NOSE], 1]
    lift = studio.root.locator(".sketchwidget-choice-gesture button", has_text="lift")
    lift.click()
    studio.page.evaluate("window.flashes = []")
    studio.draw_on_head(np.random.default_rng(0).random((20, 2)) * 0.3 + 0.3)
    until(lambda: flash(studio), lambda text: text == "lift")
    until(
        lambda: studio.positions()[model.landmarks[NOSE], 1] - before, lambda up: abs(up - 5) < 1e-2, "a head higher up"
    )
