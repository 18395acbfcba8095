"""The course's notebooks with widgets, in a real browser."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import nbformat
import pytest
from jupyter_page import DEADLINE, ROOT, open_in_lab, write_notebook
from playwright.sync_api import BrowserContext, Page
from studio_page import StudioPage, until


@pytest.fixture
def opened(servers: Callable[..., tuple[str, Path]], contexts: Callable[..., BrowserContext]) -> Callable[[str], Page]:
    """Open cells of a notebook of the course, and run them."""

    def open_page(name: str, cells: Callable[[list[str]], list[str]] = list) -> Page:
        address, folder = servers("lab")
        notebook = nbformat.read(ROOT / "notebooks" / f"{name}.ipynb", as_version=4)
        code = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
        page = contexts().new_page()
        page.set_default_timeout(1000 * DEADLINE)
        open_in_lab(page, address, write_notebook(folder, name, *cells(code)))
        return page

    return open_page


def test_the_studio_of_the_first_notebook_shows_what_its_script_draws(opened: Callable[[str], Page]) -> None:
    studio = StudioPage(opened("00_studio")).wait_until_shown()
    until(lambda: studio.message, lambda said: "Still to draw" in said and "outline" not in said, "an outline")
    until(studio.ink_pixels, what="its ink")
    outputs = studio.page.locator(".jp-OutputArea-output")
    assert not [text for text in outputs.all_inner_texts() if "Traceback" in text]


def test_the_sliders_of_the_second_notebook_move_its_head(opened: Callable[..., Page]) -> None:
    # Only what the sliders need: the rest, which takes minutes, the other tests run.
    needed = ("import sketchwidget as sw", "resting = ", "HeadView(model.face()")

    def cells(code: list[str]) -> list[str]:
        first, *others = [cell for cell in code if any(part in cell for part in needed)]
        return [first, "model = sw.FaceModel.load()", *others]

    page = opened("02_bilinear_model", cells)
    head = page.locator(".sketchwidget-head")
    head.wait_for()

    def serial() -> int:
        return head.element_handle().evaluate("head => head.sketchwidget?.serial ?? 0")

    before = until(serial, what="the head")
    page.locator(".noUi-handle").nth(1).focus()
    page.keyboard.press("ArrowRight")
    until(serial, lambda now: now > before, "another head")
