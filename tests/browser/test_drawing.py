"""Ink, head and history, as a user meets them, in JupyterLab and in Voila."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from jupyter_page import DEADLINE, launch_chromium, open_in_voila, write_notebook
from playwright.sync_api import Playwright
from studio_page import OVAL, StudioPage, until

NOSE = [(0.5, 0.42), (0.47, 0.56), (0.5, 0.58), (0.53, 0.57)]
RED = (214, 39, 40)


def drawn(studio: StudioPage, points: object = OVAL) -> None:
    """Draw a stroke and wait until the head has followed."""
    before = studio.serial
    studio.draw(points)
    studio.wait_for_frame(before)
    until(lambda: studio.message, lambda said: said.startswith("Stroke drawn"), "the word of the stroke")


def test_a_stroke_changes_the_head_on_screen(studio: StudioPage) -> None:
    mesh, picture = studio.positions(), studio.head_pixels()
    drawn(studio)
    assert np.abs(studio.positions() - mesh).max() > 0.1  # mm
    until(
        lambda: (np.abs(studio.head_pixels().astype(int) - picture).max(axis=2) > 12).mean(),
        lambda share: share > 0.002,
        "a picture of another head",
    )
    assert "inference" in studio.figures and "total" in studio.figures and studio.figures.startswith("Initial")


def test_undo_and_redo_by_keyboard(studio: StudioPage) -> None:
    first = studio.positions()
    drawn(studio)
    second, ink = studio.positions(), studio.ink_pixels()
    studio.press("Control+z")
    until(lambda: np.allclose(studio.positions(), first, atol=1e-3), what="the former head")
    until(studio.ink_pixels, lambda pixels: pixels == 0, "an empty pad")
    studio.press("Control+Shift+z")
    until(lambda: np.allclose(studio.positions(), second, atol=1e-3), what="the later head")
    until(studio.ink_pixels, lambda pixels: abs(pixels - ink) < 0.1 * ink, "the ink again")
    studio.press("Control+z")
    studio.press("Control+y")
    until(lambda: np.allclose(studio.positions(), second, atol=1e-3), what="the later head by the other key")


def test_ink_is_there_before_the_kernel_answers(studio: StudioPage) -> None:
    x, y = studio.on_screen((0.3, 0.3))
    studio.page.mouse.move(x, y)
    studio.page.mouse.down()
    studio.page.mouse.move(*studio.on_screen((0.7, 0.6)))
    until(studio.ink_pixels, what="ink under the pen")
    assert studio.pad.locator(".sketchwidget-invitation").is_hidden()
    studio.page.mouse.up()
    until(lambda: studio.message, lambda said: said.startswith("Stroke drawn"), "the word of the stroke")


def test_the_outline_turns_red_once_it_is_known(studio: StudioPage) -> None:
    drawn(studio)

    def red() -> int:
        ink = studio.ink()
        return int((np.abs(ink[..., :3].astype(int) - RED).max(axis=2) < 12)[ink[..., 3] > 200].sum())

    until(red, lambda pixels: pixels > 100, "red ink")


def test_the_eraser_takes_ink_away_and_the_head_follows(studio: StudioPage) -> None:
    drawn(studio)
    before, ink = studio.serial, studio.ink_pixels()
    studio.press("e")
    until(lambda: studio.is_on("eraser"))
    studio.draw([OVAL[5] + (0.05, 0), OVAL[5], OVAL[5] - (0.05, 0)])
    studio.wait_for_frame(before)
    until(lambda: studio.message, lambda said: said.startswith("Erased"), "the word of the erasing")
    until(studio.ink_pixels, lambda pixels: 0.5 * ink < pixels < 0.99 * ink, "less ink")
    studio.press("Control+z")
    until(studio.ink_pixels, lambda pixels: abs(pixels - ink) < 0.01 * ink, "the ink again")


def test_erasing_where_nothing_is_keeps_all(studio: StudioPage) -> None:
    drawn(studio)
    ink = studio.ink_pixels()
    studio.press("e")
    studio.draw([(0.05, 0.05), (0.1, 0.05)])
    until(lambda: studio.message, lambda said: said.startswith("Nothing to erase"), "the word of it")
    until(studio.ink_pixels, lambda pixels: abs(pixels - ink) < 0.01 * ink, "the same ink")


def test_a_stroke_that_ends_outside_the_pad_is_kept(studio: StudioPage) -> None:
    drawn(studio, [(0.5, 0.5), (0.8, 0.5), (0.95, 0.5), (1.3, 0.5), (1.3, 1.2)])
    alpha = studio.ink()[..., 3] > 0
    row = alpha[len(alpha) // 2]
    assert row[len(row) // 2 + 5 : -5].all()  # up to the edge, and
    assert not alpha[int(0.6 * len(alpha)) :].any()  # nothing along it


def test_a_stroke_across_the_edge_and_back_stays_one(studio: StudioPage) -> None:
    drawn(studio, [(0.5, 0.3), (0.9, 0.3), (1.2, 0.4), (1.2, 0.6), (0.9, 0.7), (0.5, 0.7)])
    studio.press("Control+z")
    until(studio.ink_pixels, lambda pixels: pixels == 0, "an empty pad")


@pytest.mark.parametrize("button", ["right", "middle"])
def test_only_the_main_button_draws(studio_lab: StudioPage, button: str) -> None:
    before = studio_lab.serial
    studio_lab.draw([(0.3, 0.3), (0.6, 0.6)], button=button)
    studio_lab.page.keyboard.press("Escape")  # the front end's menu
    assert studio_lab.serial == before
    drawn(studio_lab, [(0.8, 0.8), (0.9, 0.9)])
    assert not studio_lab.ink()[: studio_lab.pad_size()[0] * 7 // 10, :, 3].any()


def test_clear_by_keyboard_can_be_undone(studio: StudioPage) -> None:
    drawn(studio)
    ink = studio.ink_pixels()
    studio.press("Delete")
    until(studio.ink_pixels, lambda pixels: pixels == 0, "an empty pad")
    studio.press("Control+z")
    until(studio.ink_pixels, lambda pixels: abs(pixels - ink) < 0.01 * ink, "the ink again")


def test_what_is_cleared_is_gone_where_canvases_are_drawn_as_on_a_graphics_card(
    playwright: Playwright, servers: Callable[..., tuple[str, Path]]
) -> None:
    address, folder = servers("voila")
    notebook = write_notebook(folder, "accelerated", "import sketchwidget as sw\nsw.Studio()")
    with closing(launch_chromium(playwright, "--use-gl=angle", "--use-angle=swiftshader")) as browser:
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.set_default_timeout(1000 * DEADLINE)
        open_in_voila(page, address, notebook)
        studio = StudioPage(page).wait_until_shown()
        drawn(studio)
        studio.press("Delete")
        until(studio.ink_pixels, lambda pixels: pixels == 0, "an empty pad")
        studio.press("g")
        until(studio.ink_pixels, what="the ghost of the head")
        studio.press("g")
        until(studio.ink_pixels, lambda pixels: pixels == 0, "an empty pad again")


def test_the_front_ends_menu_does_not_open_over_the_head(studio_lab: StudioPage) -> None:
    menu = studio_lab.page.locator(".lm-Menu:visible")
    studio_lab.head.click(button="right")
    studio_lab.page.wait_for_timeout(300)
    assert menu.count() == 0
    studio_lab.root.locator(".sketchwidget-message").click(button="right")  # elsewhere it does
    menu.wait_for()
    studio_lab.page.mouse.click(2, 2)
    until(menu.count, lambda count: count == 0, "the menu's end")


def test_mirror_drawing_draws_both_sides(studio: StudioPage) -> None:
    studio.press("m")
    until(lambda: studio.is_on("mirror"))
    before = studio.serial
    studio.draw([(0.2, 0.3), (0.25, 0.4), (0.2, 0.5)])
    studio.wait_for_frame(before)
    until(lambda: studio.message, lambda said: said.startswith("Both strokes"), "the word of it")

    def halves() -> tuple[int, int]:
        alpha = studio.ink()[..., 3] > 0
        half = alpha.shape[1] // 2
        return int(alpha[:, :half].sum()), int(alpha[:, half:].sum())

    left, right = until(halves, lambda both: min(both) > 0, "ink on both sides")
    assert abs(left - right) < 0.1 * left


def test_ghost_shows_the_heads_lines(studio: StudioPage) -> None:
    studio.press("g")
    until(studio.ink_pixels, what="the ghost")
    studio.press("g")
    until(studio.ink_pixels, lambda pixels: pixels == 0, "an empty pad")


def test_touch_draws(studio_lab: StudioPage) -> None:
    studio, before = studio_lab, studio_lab.serial
    devtools = studio.page.context.new_cdp_session(studio.page)
    for kind, points in [
        ("touchStart", [(0.3, 0.3)]),
        ("touchMove", [(0.5, 0.6)]),
        ("touchMove", [(0.7, 0.3)]),
        ("touchEnd", []),
    ]:
        touches = [dict(zip("xy", studio.on_screen(point), strict=True)) for point in points]
        devtools.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touches})
    studio.wait_for_frame(before)
    until(studio.ink_pixels, what="ink")


def test_a_pen_draws(studio_lab: StudioPage) -> None:
    studio, before = studio_lab, studio_lab.serial
    devtools = studio.page.context.new_cdp_session(studio.page)
    for kind, point in [("mousePressed", (0.3, 0.3)), ("mouseMoved", (0.5, 0.6)), ("mouseReleased", (0.7, 0.3))]:
        x, y = studio.on_screen(point)
        pen = {"pointerType": "pen", "button": "left", "buttons": 1, "force": 0.5, "clickCount": 1}
        devtools.send("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": y, **pen})
    studio.wait_for_frame(before)
    until(studio.ink_pixels, what="ink")


def test_quick_strokes_all_arrive(studio: StudioPage) -> None:
    for y in (0.2, 0.4, 0.6, 0.8):
        studio.draw([(0.2, y), (0.5, y + 0.02), (0.8, y)])

    def rows() -> list[bool]:
        alpha = studio.ink()[..., 3] > 200
        return [
            bool(alpha[int((y - 0.02) * len(alpha)) : int((y + 0.05) * len(alpha))].any()) for y in (0.2, 0.4, 0.6, 0.8)
        ]

    until(rows, all, "four strokes")
    for _ in range(4):
        studio.press("Control+z")
    until(studio.ink_pixels, lambda pixels: pixels == 0, "an empty pad")


def test_normals_belong_to_the_positions_on_screen(studio_lab: StudioPage) -> None:
    drawn(studio_lab)
    index, normals = studio_lab.head.element_handle().evaluate(
        """({ sketchwidget: { geometry } }) =>
            [geometry.index, geometry.attributes.normal].map(attribute => Array.from(attribute.array))"""
    )
    vertices, faces = studio_lab.positions().astype(float), np.array(index).reshape(-1, 3)
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    expected = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(expected, faces[:, corner], np.cross(b - a, c - a))
    lengths = np.linalg.norm(expected, axis=1)
    sound = lengths > 1e-3
    cosines = (expected[sound] / lengths[sound, None] * np.reshape(normals, (-1, 3))[sound]).sum(axis=1)
    assert cosines.min() > 0.99


def test_the_head_follows_while_the_stroke_is_drawn(studio: StudioPage) -> None:
    drawn(studio)
    settled, before = studio.positions(), studio.serial
    points = [(0.40, 0.70), (0.44, 0.74), (0.5, 0.76), (0.56, 0.74), (0.60, 0.70)]
    studio.page.mouse.move(*studio.on_screen(points[0]))
    studio.page.mouse.down()
    for point in points[1:]:
        studio.page.mouse.move(*studio.on_screen(point), steps=4)
    until(lambda: studio.serial, lambda serial: serial > before, "a frame before the pen is up")
    assert np.abs(studio.positions() - settled).max() > 0.1  # mm
    studio.page.mouse.up()
    until(lambda: studio.message, lambda said: said.startswith("Stroke drawn"), "the word of the stroke")
    studio.press("Control+z")
    until(lambda: np.allclose(studio.positions(), settled, atol=1e-3), what="the former head")


def test_the_head_waits_for_the_pen_if_live_is_off(studio: StudioPage) -> None:
    drawn(studio)
    studio.press("v")
    studio.page.mouse.move(*studio.on_screen((0.4, 0.7)))
    studio.page.mouse.down()
    before = studio.serial
    studio.page.mouse.move(*studio.on_screen((0.6, 0.7)), steps=10)
    until(studio.ink_pixels, what="ink under the pen")
    studio.page.wait_for_timeout(500)
    assert studio.serial == before
    studio.page.mouse.up()
    studio.wait_for_frame(before)
