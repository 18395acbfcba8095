"""The Studio as a part of its page: keys, views, files, themes, sizes, neighbours, reloading."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import trimesh
from studio_page import OVAL, StudioPage, settled, until

BUTTONS = 37


def drawn(studio: StudioPage) -> int:
    """Draw an outline and wait until the head has followed; the pixels of ink."""
    before = studio.serial
    studio.draw(OVAL)
    studio.wait_for_frame(before)
    until(lambda: studio.message, lambda said: said.startswith("Stroke drawn"), "the word of the stroke")
    return settled(studio.ink_pixels)


def test_every_button_has_a_tooltip_that_names_its_key(studio: StudioPage) -> None:
    titles = studio.root.locator("button").evaluate_all("buttons => buttons.map(button => button.title)")
    assert len(titles) == BUTTONS
    without_key = [title for title in titles if not (title.endswith(")") and "(" in title)]
    assert [title.partition(":")[0] for title in without_key] == [
        "Load a drawing"
    ] * 3  # offered while the pad is empty


def test_icons_are_glyphs_of_the_front_ends_font(studio: StudioPage) -> None:
    icons = studio.root.locator("button i:visible").evaluate_all(
        """icons => icons.map(icon => {
            const { content, fontFamily } = getComputedStyle(icon, '::before');
            return [content, fontFamily, icon.getBoundingClientRect().width];
        })"""
    )
    assert len(icons) == 14
    for content, family, width in icons:
        assert content not in ("none", "normal", '""') and "Font Awesome" in family and width > 8
    assert studio.page.evaluate("document.fonts.check('900 14px \"Font Awesome 5 Free\"')")


def test_nothing_overflows_and_pad_and_head_are_alike(studio: StudioPage) -> None:
    overflow = studio.root.evaluate(
        """root => [root, ...root.querySelectorAll('*')]
            .filter(el => el.clientWidth)
            .filter(el => el.scrollWidth > el.clientWidth + 1 || el.scrollHeight > el.clientHeight + 1)
            .filter(el => !['CANVAS', 'I'].includes(el.tagName) && getComputedStyle(el).overflow !== 'visible')
            .map(el => el.className)"""
    )
    assert overflow == []
    pad, head = studio.pad.bounding_box(), studio.head.bounding_box()
    assert pad is not None and head is not None
    assert (pad["width"], pad["height"], pad["y"]) == pytest.approx((head["width"], head["height"], head["y"]), abs=1)


def test_a_narrow_page_stacks_pad_and_head(studio_voila: StudioPage) -> None:
    size = studio_voila.page.viewport_size
    assert size is not None
    try:
        studio_voila.page.set_viewport_size({"width": 420, "height": 900})
        until(lambda: studio_voila.head.bounding_box()["y"] > studio_voila.pad.bounding_box()["y"] + 100)  # type: ignore[index]
        assert studio_voila.page.evaluate("document.documentElement.scrollWidth") <= 420
        box = studio_voila.root.bounding_box()
        for button in studio_voila.root.locator("button:visible").all():
            place = button.bounding_box()
            assert box is not None and place is not None
            assert box["x"] <= place["x"] and place["x"] + place["width"] <= box["x"] + box["width"]
    finally:
        studio_voila.page.set_viewport_size(size)


@pytest.mark.parametrize(
    ("key", "direction"),
    [("2", (1, 0, 0)), ("3", (-1, 0, 0)), ("4", (np.sin(np.radians(40)), 0, np.cos(np.radians(40)))), ("1", (0, 0, 1))],
)
def test_views_by_key(studio: StudioPage, key: str, direction: tuple[float, ...]) -> None:
    studio.press(key)
    until(lambda: np.allclose(studio.camera()["direction"], direction, atol=1e-3), what="the view")


def test_the_front_view_has_250_mm_to_the_pads_height(studio: StudioPage) -> None:
    camera = studio.camera()
    assert camera["top"] - camera["bottom"] == pytest.approx(250) and camera["right"] - camera["left"] == pytest.approx(
        250
    )
    assert camera["top"] == pytest.approx(125) and camera["left"] == pytest.approx(-125) and camera["zoom"] == 1


def test_the_front_view_lies_under_the_drawing(studio: StudioPage) -> None:
    studio.press("g")
    until(studio.ink_pixels, what="the ghost, which is the drawing of the head on show")
    rows, columns = np.nonzero(studio.ink()[..., 3] > 100)
    ghost = np.array([columns.min(), columns.max(), rows.min()]) / studio.pad_size()[0]

    picture = studio.head_pixels().astype(int)[3:-3, 3:-3]
    head = np.abs(picture - picture[5, 5]).max(axis=2) > 25
    rows, columns = np.nonzero(head[: int(0.8 * len(head))])  # without the neck, which no line goes round
    shown = (np.array([columns.min(), columns.max(), rows.min()]) + 3) / (len(head) + 6)
    np.testing.assert_allclose(shown, ghost, atol=0.015)  # ears and crown, in canvas units


def test_a_drag_turns_the_head(studio: StudioPage) -> None:
    box = studio.head.bounding_box()
    assert box is not None
    studio.page.mouse.move(box["x"] + 200, box["y"] + 200)
    studio.page.mouse.down()
    studio.page.mouse.move(box["x"] + 280, box["y"] + 210, steps=4)
    studio.page.mouse.up()
    until(lambda: studio.camera()["direction"][2] < 0.9, what="a turned head")


def test_exports_open_in_trimesh(studio: StudioPage, tmp_path: Path) -> None:
    drawn(studio)
    for suffix, key, scale in (("obj", "o", 1), ("glb", "b", 1000)):  # a glTF file is in metres
        with studio.page.expect_download() as download:
            studio.press(key)
        path = tmp_path / download.value.suggested_filename
        assert path.suffix == f".{suffix}"
        download.value.save_as(path)
        mesh = trimesh.load(path, force="mesh", process=False)
        bounds = np.array(mesh.bounds) * scale
        shown = studio.positions()
        assert np.allclose(bounds, [shown.min(axis=0), shown.max(axis=0)], atol=0.01)


def test_a_saved_session_loads_and_loading_can_be_undone(studio: StudioPage, tmp_path: Path) -> None:
    ink, mesh = drawn(studio), studio.positions()
    with studio.page.expect_download() as download:
        studio.press("s")
    path = tmp_path / download.value.suggested_filename
    download.value.save_as(path)
    studio.click("clear")
    until(studio.ink_pixels, lambda pixels: pixels == 0, "an empty pad")

    with studio.page.expect_file_chooser() as chooser:
        studio.press("l")
    chooser.value.set_files(path)
    until(studio.ink_pixels, lambda pixels: abs(pixels - ink) < 0.02 * ink, "the saved ink")
    until(lambda: np.allclose(studio.positions(), mesh, atol=0.05), what="the saved head")
    studio.press("Control+z")
    until(studio.ink_pixels, lambda pixels: pixels == 0, "the drawing from before the loading")


def test_a_file_that_is_no_session_is_refused_in_the_status_line(studio: StudioPage, tmp_path: Path) -> None:
    ink = drawn(studio)
    bad = tmp_path / "letter.jsonl"
    bad.write_text("Dear reader\n")
    with studio.page.expect_file_chooser() as chooser:
        studio.click("load")
    chooser.value.set_files(bad)
    message = until(lambda: studio.message, lambda said: "letter.jsonl" in said, "the refusal")
    assert "Traceback" not in message and message.endswith(".")
    assert studio.ink_pixels() == ink


def test_keys_leave_a_cells_editor_alone(studio_lab: StudioPage) -> None:
    ink = drawn(studio_lab)
    page = studio_lab.page
    page.locator(".jp-Notebook .cm-content").first.click()
    studio_lab.pad.hover()
    page.keyboard.type("e")
    page.keyboard.press("Control+z")
    page.keyboard.press("Delete")
    assert studio_lab.is_on("pen") and studio_lab.ink_pixels() == ink
    page.keyboard.press("Escape")


def test_keys_do_nothing_away_from_the_studio(studio_lab: StudioPage) -> None:
    ink = drawn(studio_lab)
    studio_lab.page.locator(".jp-Notebook .cm-content").first.click()
    studio_lab.page.keyboard.press("Escape")  # the notebook's command mode
    studio_lab.page.mouse.move(5, 5)
    studio_lab.page.keyboard.press("p")
    studio_lab.page.keyboard.press("Control+z")
    assert studio_lab.ink_pixels() == ink


def test_two_studios_on_a_page_do_not_interfere(open_studio: Callable[..., StudioPage]) -> None:
    first = open_studio("voila", code="display(sw.Studio(), sw.Studio())")
    second = StudioPage(first.page, 1).wait_until_shown()
    serial = second.serial
    first.root.scroll_into_view_if_needed()
    ink = drawn(first)
    second.root.scroll_into_view_if_needed()
    assert second.ink_pixels() == 0 and second.serial == serial
    second.press("e")
    until(lambda: second.is_on("eraser"))
    assert first.is_on("pen")
    second.press("p")
    until(lambda: second.is_on("pen"))
    drawn(second)
    second.press("Control+z")
    until(second.ink_pixels, lambda pixels: pixels == 0, "an empty second pad")
    assert first.ink_pixels() == ink


def test_a_studio_shown_twice_is_one_studio(open_studio: Callable[..., StudioPage]) -> None:
    first = open_studio("voila", code="studio = sw.Studio()\ndisplay(studio, studio)")
    second = StudioPage(first.page, 1).wait_until_shown()
    ink = drawn(second)
    assert np.array_equal(second.positions(), first.positions())
    first.root.scroll_into_view_if_needed()
    until(first.ink_pixels, lambda pixels: abs(pixels - ink) < 0.02 * ink, "the same drawing")
    first.press("Control+z")
    for shown in (first, second):
        until(shown.ink_pixels, lambda pixels: pixels == 0, "an empty pad")
    assert first.message == second.message


def test_on_a_page_zoomed_in_strokes_land_under_the_pen_and_all_is_sharp(studio_voila: StudioPage) -> None:
    # What a browser's zoom of 150 % is to a page: as many pixels, but fewer and larger units.
    devtools = studio_voila.page.context.new_cdp_session(studio_voila.page)
    zoomed = {"width": 853, "height": 600, "deviceScaleFactor": 1.5, "mobile": False}
    devtools.send("Emulation.setDeviceMetricsOverride", zoomed)
    try:
        until(studio_voila.pad_size, lambda size: size[0] >= size[1] - 1, "a pad as fine as the screen")
        studio_voila.pad.scroll_into_view_if_needed()
        drawn(studio_voila)
        rows, columns = np.nonzero(studio_voila.ink()[..., 3] > 200)
        seen = np.array([columns.min(), columns.max(), rows.min(), rows.max()]) / studio_voila.pad_size()[0]
        (left, top), (right, bottom) = OVAL.min(axis=0), OVAL.max(axis=0)
        np.testing.assert_allclose(seen, [left, right, top, bottom], atol=0.01)
    finally:
        devtools.send("Emulation.clearDeviceMetricsOverride")
        devtools.detach()


def test_the_drawing_is_there_again_after_a_reload(studio_lab: StudioPage) -> None:
    ink, mesh = drawn(studio_lab), studio_lab.positions()
    page = studio_lab.page
    page.evaluate("window.jupyterapp.commands.execute('docmanager:save')")
    page.reload()
    studio_lab.wait_until_shown()
    until(studio_lab.ink_pixels, lambda pixels: abs(pixels - ink) < 0.02 * ink, "the drawing")
    assert np.allclose(studio_lab.positions(), mesh, atol=1e-3)
    studio_lab.press("Control+z")
    until(studio_lab.ink_pixels, lambda pixels: pixels == 0, "an empty pad")


def test_what_a_script_draws_before_the_page_connects_is_shown(open_studio: Callable[..., StudioPage]) -> None:
    code = "studio = sw.Studio()\nstudio.session.draw([(0.2, 0.2), (0.5, 0.8), (0.8, 0.2)])\nstudio"
    studio = open_studio("voila", code=code, device_scale_factor=2)
    until(studio.ink_pixels, what="the script's stroke")
    store, screen = studio.pad_size()
    assert abs(store - screen) <= 2  # sharp: a pixel of the canvas for each of the screen
    head, width = studio.head.locator("canvas").first.evaluate("canvas => [canvas.width, canvas.clientWidth]")
    assert head == pytest.approx(2 * width, abs=2)


@pytest.mark.parametrize("kind", ["lab", "voila"])
def test_a_page_that_is_slow_to_build_still_hears_from_the_kernel(
    open_studio: Callable[..., StudioPage], kind: str
) -> None:
    # Whatever the front end gives a limited time, it gives none: every widget's module comes too late.
    hurry = """AbortSignal.timeout = () => {
        const controller = new AbortController();
        queueMicrotask(() => controller.abort());
        return controller.signal;
    };"""
    studio = open_studio(kind, script=hurry)
    drawn(studio)
    with studio.page.expect_download() as download:
        studio.press("o")
    assert download.value.suggested_filename == "head.obj"


@pytest.mark.skipif(find_spec("notebook") is None, reason="Notebook 7 is not installed")
def test_notebook_7(open_studio: Callable[..., StudioPage]) -> None:
    studio = open_studio("notebook")
    before = studio.positions()
    drawn(studio)
    assert np.abs(studio.positions() - before).max() > 0.1  # mm
    studio.press("Control+z")
    until(studio.ink_pixels, lambda pixels: pixels == 0, "an empty pad")


def test_dark_theme(open_studio: Callable[..., StudioPage]) -> None:
    studio = open_studio("voila", "--theme=dark")
    drawn(studio)
    corner = studio.head_pixels()[8, 8]
    assert corner.max() < 90
    paper = studio.pad.evaluate("pad => getComputedStyle(pad).backgroundColor")
    assert all(int(value) < 90 for value in paper.strip("rgb()").split(","))
