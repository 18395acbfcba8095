"""Follow-up sketching, as a user meets it."""

from __future__ import annotations

import os

import numpy as np
import pytest
from studio_page import StudioPage, until

import sketchwidget as sw
from sketchwidget.face.drawing import editable
from sketchwidget.geometry import View

GREEN, FAINT = (13, 131, 119), (176, 212, 207)  # open ends, and the ghost of what was erased
SCREENSHOTS = os.environ.get("SKETCHWIDGET_SCREENSHOTS")  # a folder for pictures of what the tests saw


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


def coloured(studio: StudioPage, colour: tuple[int, int, int]) -> np.ndarray:
    """Places (n, 2) on the canvas that are inked in a colour."""
    ink = studio.ink().astype(int)
    rows, columns = np.nonzero((ink[..., 3] > 128) & (np.abs(ink[..., :3] - colour).max(axis=2) < 12))
    return np.stack([columns, rows], axis=1) / len(ink)


def near(places: np.ndarray, point: np.ndarray, within: float = 0.012) -> bool:
    return bool(len(places)) and np.linalg.norm(places - point, axis=1).min() < within


def test_a_higher_brow_raises_the_brow_of_the_head(studio, model, lines) -> None:
    brow = model.curves["left_brow"]
    before, serial, piece = studio.positions()[brow], studio.serial, lines["left_brow"][0]
    erase(studio, piece)
    assert "Now draw the left brow anew" in studio.message
    until(lambda: len(coloured(studio, GREEN)), what="the marked end")
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


def test_open_ends_are_marked_and_what_was_erased_is_a_ghost(studio, lines) -> None:
    before, piece, after = lines["nose"]
    erase(studio, piece)
    marks = until(lambda: coloured(studio, GREEN), len, "the marked ends")
    assert near(marks, before[-1]) and near(marks, after[0]) and not near(marks, piece[len(piece) // 2])
    ghost = until(lambda: coloured(studio, FAINT), len, "the ghost")
    assert all(near(ghost, point) for point in piece[2:-2])
    assert not any(near(ghost, point) for point in np.concatenate([before[:-3], after[3:]]))
    studio.press("Escape")
    until(lambda: len(coloured(studio, GREEN)) + len(coloured(studio, FAINT)), lambda count: not count, "no marks")


def test_a_mirrored_stroke_draws_both_brows(studio, model, lines) -> None:
    brows = [model.curves[f"{side}_brow"] for side in ("left", "right")]
    before = studio.positions()
    for piece in lines["left_brow"]:
        erase(studio, piece)
    studio.click("mirror")
    until(lambda: studio.is_on("mirror"), what="the toggle")
    whole = np.concatenate(lines["left_brow"]) - [0, 0.03]
    studio.draw(whole)
    anew = "The left brow is drawn anew, and the right one with it."
    until(lambda: studio.message, lambda said: said.startswith(anew), "the word of the stroke")
    rises = until(
        lambda: [(studio.positions() - before)[brow, 1] for brow in brows],
        lambda rises: min(rise.min() for rise in rises) > 5,
        "two higher brows",
    )
    assert rises[0] == pytest.approx(rises[1], abs=0.6)
    keep_picture(studio, "mirrored")


def test_the_head_follows_while_a_line_is_drawn(studio, model, lines) -> None:
    brow = model.curves["left_brow"]
    before = studio.positions()[brow]
    for piece in lines["left_brow"]:
        erase(studio, piece)
    first, *others = np.concatenate(lines["left_brow"]) - [0, 0.03]
    studio.page.mouse.move(*studio.on_screen(first))
    studio.page.mouse.down()
    for point in others[:6]:
        studio.page.mouse.move(*studio.on_screen(point))
    rise = until(
        lambda: studio.page.mouse.move(*studio.on_screen(others[6])) or (studio.positions()[brow] - before)[:, 1],
        lambda rise: rise[0] > 5,
        "a brow that rises",
    )
    assert rise[-1] < 2
    keep_picture(studio, "half a brow")
    for point in others[7:]:
        studio.page.mouse.move(*studio.on_screen(point))
    studio.page.mouse.up()
    until(lambda: studio.message, lambda said: said.startswith("The left brow is drawn anew"), "the word of the stroke")
    until(lambda: (studio.positions()[brow] - before)[:, 1].min(), lambda least: least > 5, "a higher brow")


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


def test_hovering_over_the_outline_shows_what_the_eraser_covers(studio, lines) -> None:
    taken, cover = (studio.root.locator(f".sketchwidget-taken {what}") for what in ("polyline", "circle"))
    outline = lines["silhouette"][0]
    chin = outline[np.argmax(outline[:, 1])]
    beside = chin + np.array([0, 0.005])
    studio.press("e")
    studio.page.mouse.move(*studio.on_screen(beside))
    marked = until(lambda: taken.get_attribute("points"), what="the mark")
    np.testing.assert_allclose(np.array(marked.split(), dtype=float).reshape(-1, 2), outline, atol=2e-4)
    assert (taken.get_attribute("clip-path") or "").startswith("url(#")
    circle = [float(cover.get_attribute(name) or "nan") for name in ("cx", "cy", "r")]
    assert circle == pytest.approx([*beside, 0.02], abs=4e-3)
    keep_picture(studio, "hover over the outline")
    studio.draw([chin])
    until(lambda: studio.message, lambda said: said.startswith("Erased."), "the word of the eraser")
    studio.page.mouse.move(*studio.on_screen(lines["nose"][0][3]))
    until(lambda: taken.get_attribute("points"), lambda points: not points, "no mark")


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
