"""The Portrait tab, as a user meets it: a picture becomes a head that moves, is exported and edited."""

from __future__ import annotations

import io
import os

import numpy as np
import pytest
import trimesh
from jupyter_page import DEADLINE
from PIL import Image
from studio_page import StudioPage, until

import sketchwidget as sw

SIZE = 480
CHIN = 8
SCREENSHOTS = os.environ.get("SKETCHWIDGET_SCREENSHOTS")  # a folder for pictures of what the tests saw


@pytest.fixture(scope="module")
def drawn(model: sw.FaceModel) -> tuple[bytes, np.ndarray]:
    """A picture of a head as a file, and its landmarks (68, 2) in pixels."""
    view = sw.View(sw.View.preset("front").rotation, 1 / 280, np.array([0.5, 0.5]))
    face = model.face(model.bilinear.identities[4 * 33])
    file = io.BytesIO()
    Image.fromarray(face.picture(view, SIZE)).save(file, "PNG")
    return file.getvalue(), SIZE * view.project(face.landmarks)


@pytest.fixture(scope="module")
def page(open_studio) -> StudioPage:
    # No models: landmarks are begun by three clicks, whatever this machine's cache holds.
    return open_studio(
        "lab", code="from sketchwidget.widgets import marking\nmarking.missing = lambda: ['all']\nsw.Studio()"
    )


@pytest.fixture(scope="module")
def built(page: StudioPage, drawn) -> StudioPage:
    """The tab with the head of the picture."""
    data, landmarks = drawn
    page.head.hover()
    page.page.keyboard.press("x")
    page.picture.wait_for()
    assert "sketchwidget models" in page.open_and_click("someone.png", data, landmarks[[36, 45, CHIN]])
    until(lambda: page.message, lambda said: said.startswith("The head is built in"), "the head")
    until(lambda: textured(page), what="the texture on the head")
    until(lambda: slider(page, "jawOpen").count(), what="the sliders")
    keep_picture(page, "built")
    return page


def keep_picture(studio: StudioPage, name: str) -> None:
    if SCREENSHOTS:
        studio.root.screenshot(path=f"{SCREENSHOTS}/portrait-{name}.png")


def textured(studio: StudioPage) -> bool:
    return studio.root.locator(".sketchwidget-head.sketchwidget-textured").count() == 1


def slider(studio: StudioPage, expression: str):
    return studio.root.locator(f'[data-expression="{expression}"]')


def push(studio: StudioPage, part: str, expression: str) -> None:
    """Push the slider of an expression, which is in a part of the list, all the way."""
    if not slider(studio, expression).is_visible():
        studio.root.locator("summary", has_text=part).click()
    slider(studio, expression).fill("1")


def chin(studio: StudioPage, model: sw.FaceModel) -> float:
    return float(studio.positions()[model.landmarks[CHIN], 1])


def test_stages_are_shown_with_their_times(built) -> None:
    captions = built.root.locator(".sketchwidget-stages figcaption").all_inner_texts()
    assert [text.split()[0] for text in captions] == [
        "landmarks", "cartoon", "mask", "coarse", "fine", "rig", "texture"
    ]  # fmt: skip
    assert all(text.endswith(" ms") for text in captions)
    assert built.root.locator(".sketchwidget-stages figure > img + figcaption").count() == len(captions)


def test_a_slider_opens_the_jaw_on_the_page(built, model) -> None:
    before = chin(built, model)
    push(built, "Jaw", "jawOpen")
    until(lambda: chin(built, model), lambda now: now < before - 8, "a lower chin")
    keep_picture(built, "jaw")
    built.root.locator(".sketchwidget-performances button", has_text="rest").click()
    until(lambda: chin(built, model), lambda now: abs(now - before) < 0.01, "the chin at rest")


def test_eyeballs_turn_whole(built, model) -> None:
    from sketchwidget.face.template import PARTS

    ball = (model.template.fine_parts == PARTS.index("eyes")) & (model.mean[:, 0] > 0)
    rest = built.positions()[ball]
    push(built, "Eyes", "eyeLookUpLeft")
    until(lambda: np.abs(built.positions()[ball] - rest).max(), lambda moved: moved > 2, "a look upwards")
    turned = built.positions()[ball]
    apart = [np.linalg.norm(points[::7, None] - points[::7], axis=2) for points in (rest, turned)]
    np.testing.assert_allclose(apart[1], apart[0], atol=1e-2)  # rigid
    built.root.locator(".sketchwidget-performances button", has_text="rest").click()
    until(lambda: np.abs(built.positions()[ball] - rest).max(), lambda moved: moved < 0.01, "eyes at rest")


def test_a_performance_plays_and_ends_at_rest(built, model) -> None:
    # Followed on the page, frame by frame: a look from here may come after all is over. Of few frames none may show the
    # jaw far open; then it is played again.
    before, lowest, after = built.head.element_handle().evaluate(
        """async (head, vertex) => {
            const height = () => head.sketchwidget.geometry.getAttribute('position').array[3 * vertex + 1];
            const before = height();
            let lowest = before;
            for (let tries = 0; tries < 5 && lowest > before - 2; tries += 1) {
                head.closest('.sketchwidget-studio').querySelector('[data-performance="speak"]').click();
                const ends = performance.now() + 15000;
                do {
                    await new Promise(requestAnimationFrame);
                    lowest = Math.min(lowest, height());
                } while (performance.now() < ends && (lowest > before - 2 || Math.abs(height() - before) > 0.01));
            }
            return [before, lowest, height()];
        }""",
        int(model.landmarks[CHIN]),
    )
    assert lowest < before - 2  # the jaw moves
    assert abs(after - before) < 0.01  # and is at rest after it


def test_an_expression_is_there_again_after_a_reload(built, model) -> None:
    before = chin(built, model)
    push(built, "Jaw", "jawOpen")
    opened = until(lambda: chin(built, model), lambda now: now < before - 8, "a lower chin")
    built.page.evaluate("window.jupyterapp.commands.execute('docmanager:save')")
    built.page.reload()
    built.root.locator(".sketchwidget-shown").wait_for(timeout=1000 * DEADLINE)
    until(lambda: chin(built, model), lambda now: abs(now - opened) < 0.01, "the chin as low as before")
    assert slider(built, "jawOpen").input_value() == "1"
    built.root.locator(".sketchwidget-performances button", has_text="rest").click()
    until(lambda: chin(built, model), lambda now: abs(now - before) < 0.01, "the chin at rest")


def test_the_head_is_exported_with_texture_and_expressions(built) -> None:
    with built.page.expect_download() as download:
        built.click("glb")
    scene = trimesh.load(download.value.path(), file_type="glb")
    head = scene.geometry["head"]
    assert head.visual.material.baseColorTexture.size == (1024, 1024)


def test_the_head_is_taken_over_and_edited_with_its_texture(built, model) -> None:
    rest = built.positions()
    built.click("take")
    until(lambda: built.is_on("followup"), what="the tab of follow-up sketching")
    until(built.ink_pixels, what="its lines")
    np.testing.assert_allclose(built.positions(), rest, atol=0.01)
    assert textured(built)
    built.raise_half_of(model.curves["left_brow"])
    assert textured(built)
    keep_picture(built, "edited")
    for _ in range(3):
        built.press("Control+z")
    until(lambda: not textured(built), what="clay, once the taking over is undone")


def test_what_is_no_picture_is_told(page) -> None:
    page.head.hover()
    page.page.keyboard.press("x")
    page.picture.wait_for()
    page.open_picture("letter.png", b"Dear reader")
    until(lambda: page.message, lambda said: said.startswith("letter.png was not opened"), "the refusal")
