"""Follow-up sketching, as a user meets it."""

from __future__ import annotations

import os

import numpy as np
import pytest
from studio_page import StudioPage, until

import sketchwidget as sw
from sketchwidget.face.drawing import editable
from sketchwidget.geometry import View

GREEN = (13, 131, 119)
SCREENSHOTS = os.environ.get("SKETCHWIDGET_SCREENSHOTS")  # a folder for pictures of what the tests saw


@pytest.fixture(scope="module")
def model() -> sw.FaceModel:
    return sw.FaceModel.load()


@pytest.fixture(scope="module")
def lines(model: sw.FaceModel) -> dict[str, list[np.ndarray]]:
    """What the Studio shows once it starts from the template."""
    shown = editable(model.template, model.mean, View()).lines
    return {name: [points.astype(float) for points in pieces] for name, pieces in shown.items()}


@pytest.fixture
def studio(studio_lab: StudioPage) -> StudioPage:
    studio_lab.press("t")
    until(lambda: studio_lab.message, lambda said: said.startswith("These are the lines"), "the lines of the template")
    until(lambda: studio_lab.is_on("followup"), what="the tab of follow-up sketching")
    return studio_lab


def keep_picture(studio: StudioPage, name: str) -> None:
    if SCREENSHOTS:
        studio.root.screenshot(path=f"{SCREENSHOTS}/{name}.png")


def erase(studio: StudioPage, points: np.ndarray) -> None:
    studio.press("e")
    studio.draw([points[len(points) // 2]])
    until(lambda: studio.message, lambda said: said.startswith("Erased."), "the word of the eraser")
    studio.press("p")


def green_pixels(studio: StudioPage) -> int:
    ink = studio.ink().astype(int)
    return int(((ink[..., 3] > 128) & (np.abs(ink[..., :3] - GREEN).max(axis=2) < 12)).sum())


def test_a_higher_brow_raises_the_brow_of_the_head(studio, model, lines) -> None:
    brow = model.curves["left_brow"]
    before, serial, piece = studio.positions()[brow], studio.serial, lines["left_brow"][0]
    erase(studio, piece)
    assert "Now draw the left brow anew" in studio.message
    until(lambda: green_pixels(studio), what="the marked end")
    keep_picture(studio, "gap")
    studio.draw(piece[::-1] - np.array([0, 0.03]))
    until(lambda: studio.message, lambda said: said.startswith("The left brow is drawn anew"), "the word of the stroke")
    studio.wait_for_frame(serial)
    rise = until(
        lambda: (studio.positions()[brow] - before)[: len(piece) - 2, 1],
        lambda rise: rise.max() > 5,
        "a higher brow",
    )
    assert rise.min() > 1
    keep_picture(studio, "brow")
    studio.press("Control+z")
    studio.press("Control+z")
    until(lambda: np.allclose(studio.positions()[brow], before, atol=1e-3), what="the former brow")


def test_the_lower_contour_of_the_mouth_follows_the_upper_one(studio, model, lines) -> None:
    upper, lower = (model.curves[f"mouth_{side}"] for side in ("upper", "lower"))
    before = studio.positions()
    for piece in lines["mouth_upper"]:
        erase(studio, piece)
    whole = np.concatenate(lines["mouth_upper"])
    studio.draw((whole - whole.mean(axis=0)) * 1.3 + whole.mean(axis=0) - np.array([0, 0.02]))
    until(
        lambda: studio.message,
        lambda said: said.startswith("The upper contour of the mouth is drawn"),
        "the word of the stroke",
    )
    wide = until(
        lambda: np.ptp(studio.positions()[lower, 0]) / np.ptp(before[lower, 0]), lambda wide: wide > 1.2, "a wide lip"
    )
    after = studio.positions()
    assert wide == pytest.approx(np.ptp(after[upper, 0]) / np.ptp(before[upper, 0]), rel=1e-3)
    assert (after[lower, 1] - before[lower, 1]).mean() > 3
    keep_picture(studio, "mouth")


def test_hovering_shows_what_the_eraser_would_take(studio, lines) -> None:
    taken = studio.root.locator(".sketchwidget-taken polyline")
    piece = lines["nose"][0]
    studio.press("e")
    studio.page.mouse.move(*studio.on_screen(piece[len(piece) // 2]))
    marked = until(lambda: taken.get_attribute("points"), what="the mark")
    ends = np.array(marked.split(), dtype=float).reshape(-1, 2)[[0, -1]]
    np.testing.assert_allclose(ends, piece[[0, -1]], atol=2e-4)
    keep_picture(studio, "hover")
    studio.page.mouse.move(*studio.on_screen((0.5, 0.15)))
    until(lambda: taken.get_attribute("points"), lambda points: not points, "no mark")
    studio.press("p")
    studio.page.mouse.move(*studio.on_screen(piece[len(piece) // 2]))
    assert not taken.get_attribute("points")


def test_the_profile_is_dragged_in_the_side_view(studio, model, lines) -> None:
    before = studio.positions()
    studio.press("2")
    until(lambda: studio.message, lambda said: said.startswith("Draw beside the profile"), "the profile")
    until(lambda: not studio.turning(), what="the view from the side")
    profile = View.preset("left").project(model.mean[model.handles.profile])
    studio.draw(profile[50:68] - np.array([0.03, 0.0]))
    until(lambda: studio.message, lambda said: said.startswith("The profile follows"), "the word of the stroke")
    until(lambda: (studio.positions() - before)[model.landmarks[30], 2], lambda forward: forward > 4, "a longer nose")
    keep_picture(studio, "profile")
