"""The Caricature tab, as a user meets it; the picture is one of a head of our own."""

from __future__ import annotations

import io
import os

import numpy as np
import pytest
from PIL import Image
from studio_page import OVAL, StudioPage, settled, until

import sketchwidget as sw

SIZE = 480
NOSE_TIP, UNDER_NOSE, CHIN = 30, 33, 8
# Faces are begun by three clicks, whether the models that find them are on this machine or not.
CODE = """
from pathlib import Path
from sketchwidget.portrait import models
models.folder = lambda: Path("nowhere")
sw.Studio()
"""
SCREENSHOTS = os.environ.get("SKETCHWIDGET_SCREENSHOTS")  # a folder for pictures of what the tests saw


@pytest.fixture(scope="module")
def view() -> sw.View:
    return sw.View(sw.View.preset("front").rotation, 1 / 280, np.array([0.5, 0.5]))


@pytest.fixture(scope="module")
def drawn(model: sw.FaceModel, view: sw.View) -> tuple[bytes, np.ndarray]:
    """A picture of a head as a file, and its landmarks (68, 2) in pixels."""
    face = model.face(model.bilinear.identities[4 * 33])
    file = io.BytesIO()
    Image.fromarray(face.picture(view, SIZE)).save(file, "PNG")
    return file.getvalue(), SIZE * view.project(face.landmarks)


@pytest.fixture(scope="module")
def page(open_studio) -> StudioPage:
    return open_studio("lab", code=CODE)


@pytest.fixture
def tab(page: StudioPage) -> StudioPage:
    page.page.bring_to_front()
    page.head.hover()
    page.page.keyboard.press("c")
    page.picture.wait_for()
    return page


def keep_picture(studio: StudioPage, name: str) -> None:
    if SCREENSHOTS:
        studio.root.screenshot(path=f"{SCREENSHOTS}/caricature-{name}.png")


def nose_length(studio: StudioPage, model: sw.FaceModel) -> float:
    """Millimetres from between the eyes to under the nose."""
    landmarks = studio.positions()[model.landmarks]
    return float(landmarks[27, 1] - landmarks[UNDER_NOSE, 1])


def begin(studio: StudioPage, drawn: tuple[bytes, np.ndarray]) -> None:
    """Open the picture and click the three points."""
    data, landmarks = drawn
    studio.open_and_click("someone.png", data, landmarks[[36, 45, CHIN]])
    until(lambda: len(studio.marks()), lambda marks: marks == 68, "the landmarks")
    until(lambda: studio.message, lambda said: said.startswith("The head fits"), "the fit")


def test_dragging_the_nose_down_lengthens_the_nose_of_the_head(tab, drawn, model) -> None:
    keep_picture(tab, "empty")
    begin(tab, drawn)
    keep_picture(tab, "begun")
    before, serial = nose_length(tab, model), tab.serial
    start = tab.marks()
    for number in (NOSE_TIP, UNDER_NOSE):
        tab.page.mouse.move(*tab.on_picture(start[number]))
        tab.page.mouse.down()
        for step in range(1, 9):
            tab.page.mouse.move(*tab.on_picture(start[number] + [0, 5 * step]))
        if number == UNDER_NOSE:
            assert tab.marks()[number, 1] - start[number, 1] == pytest.approx(40, abs=2)  # under the pointer at once
            tab.wait_for_frame(serial)
        tab.page.mouse.up()
    until(lambda: nose_length(tab, model), lambda length: length > before + 5, "a longer nose")
    until(lambda: tab.message, lambda said: said.startswith("The head fits"), "the fit")
    keep_picture(tab, "nose")


def test_the_slider_exaggerates_beyond_the_picture_and_the_head_is_taken_over(tab, drawn, model) -> None:
    begin(tab, drawn)
    fitted, serial = tab.positions(), tab.serial
    slide(tab, 12)
    tab.wait_for_frame(serial)
    until(
        lambda: np.linalg.norm(tab.positions() - model.mean, axis=1).mean(),
        lambda away: away > 1.2 * np.linalg.norm(fitted - model.mean, axis=1).mean(),
        "an exaggerated head",
    )
    keep_picture(tab, "exaggerated")
    taken = tab.positions()
    tab.click("take")
    until(lambda: tab.is_on("followup"), what="the tab of follow-up sketching")
    until(lambda: tab.message, lambda said: said.startswith("The head is taken over"), "the word of the tab")
    until(tab.ink_pixels, what="its lines")
    np.testing.assert_allclose(tab.positions(), taken, atol=0.01)
    keep_picture(tab, "taken")

    # Its lines are edited: a brow is raised, and the rest stays.
    tab.raise_half_of(model.curves["left_brow"])
    # The other lines stay; between them, what is inferred from the new ones changes a little everywhere.
    moved = tab.positions() - taken
    assert np.abs(moved[model.curves["mouth_upper"], :2]).max() < 0.5
    assert np.median(np.linalg.norm(moved, axis=1)) < 2
    keep_picture(tab, "edited")


def slide(studio: StudioPage, steps: int) -> None:
    """Move the slider of exaggeration by its keys."""
    studio.root.locator(".sketchwidget-exaggeration .noUi-handle").focus()
    for _ in range(abs(steps)):
        studio.page.keyboard.press("ArrowRight" if steps > 0 else "ArrowLeft")


def test_any_head_is_exaggerated_and_all_moves_of_the_slider_are_one_step(page, model) -> None:
    studio = page
    studio.page.bring_to_front()
    studio.head.hover()
    studio.page.keyboard.press("i")
    until(lambda: studio.is_on("initial"), what="the tab of initial sketching")
    studio.start_afresh()
    serial = studio.serial
    studio.draw(OVAL)
    studio.draw([(0.4, 0.45), (0.45, 0.43), (0.5, 0.45)])
    until(lambda: studio.message, lambda said: said.startswith("Stroke drawn."), "the word of the stroke")
    studio.wait_for_frame(serial)
    ink, before = settled(studio.ink_pixels), studio.positions()
    slide(studio, 10)
    until(
        lambda: studio.message,
        lambda said: said.startswith("Exaggerated by a factor of 1.50"),
        "the word of the slider",
    )
    away = [np.linalg.norm(mesh - model.mean, axis=1).mean() for mesh in (before, studio.positions())]
    assert away[1] > 1.2 * away[0]
    keep_picture(studio, "any-head")
    studio.press("Control+z")
    until(lambda: np.allclose(studio.positions(), before, atol=1e-3), what="the head of before")
    until(studio.ink_pixels, lambda pixels: abs(pixels - ink) < 0.02 * ink, "the drawing of before")


def test_quick_arrow_keys_all_count(tab, drawn) -> None:
    begin(tab, drawn)
    before = tab.marks()
    tab.page.mouse.click(*tab.on_picture(before[NOSE_TIP]))
    for _ in range(12):
        tab.page.keyboard.press("ArrowRight")
    until(lambda: tab.message, lambda said: said.startswith("The head fits"), "the fit")
    moved = settled(lambda: tuple((tab.marks() - before)[NOSE_TIP]))
    side = float((tab.picture.locator("svg").get_attribute("viewBox") or "").split()[2])
    assert moved == pytest.approx((12 * 0.002 * side, 0), abs=0.05)


def test_bad_files_are_a_sentence_and_lose_nothing(tab, drawn) -> None:
    begin(tab, drawn)
    before = tab.marks()
    for name, data, reason in (
        ("letter.png", b"Dear reader", "is no picture"),
        ("cut.png", drawn[0][:400], "damaged"),
        ("dot.png", _png(np.zeros((8, 8, 3), dtype=np.uint8)), "8 x 8 pixels"),
    ):
        tab.open_picture(name, data)
        said = until(lambda: tab.message, lambda said, name=name: said.startswith(name), "the refusal")
        assert "was not opened, all is as it was" in said and reason in said
        np.testing.assert_array_equal(tab.marks(), before)


def test_landmarks_that_are_no_face_are_told(tab, drawn) -> None:
    data, landmarks = drawn
    tab.open_and_click("someone.png", data, landmarks[[36, 45]])
    tab.page.mouse.click(*tab.on_picture(landmarks[27] - [0, 80]))  # a chin above the eyes
    until(lambda: tab.message, lambda said: said.startswith("No face can be there"), "the refusal")
    assert len(tab.marks()) == 2


def _png(pixels: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()
