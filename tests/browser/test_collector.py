"""The collector of drawings, as a user meets it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from studio_page import OVAL, StudioPage, until

from sketchwidget.database.drawings import read_drawings


def test_a_drawing_is_kept_with_time_and_pressure(open_studio: Callable[..., StudioPage], tmp_path: Path) -> None:
    path = tmp_path / "pupil.jsonl"
    collector = open_studio("voila", code=f"sw.DrawingCollector({str(path)!r})")
    camera, head = collector.camera(), collector.positions()
    x, y = collector.head.bounding_box()["x"] + 50, collector.head.bounding_box()["y"] + 50  # type: ignore[index]
    collector.page.mouse.move(x, y)
    collector.page.mouse.down()
    collector.page.mouse.move(x + 100, y)
    collector.page.mouse.up()

    collector.draw(OVAL)
    collector.draw([(0.42, 0.7), (0.5, 0.72), (0.58, 0.7)])
    until(lambda: collector.is_useful("keep"), what="a drawing to keep")
    assert collector.camera() == camera  # the head stays as it is
    collector.click("keep")
    [drawing] = until(lambda: read_drawings(path), what="a drawing in the file")
    until(collector.ink_pixels, lambda pixels: pixels == 0, "an empty pad")
    until(lambda: np.abs(collector.positions() - head).max() > 0.1, what="the next head")

    outline, mouth = drawing.strokes
    assert len(outline) >= len(OVAL) and len(mouth) >= 3
    np.testing.assert_allclose(outline[0, :2], OVAL[0], atol=0.005)
    assert outline[0, 3] == 0 and outline[-1, 3] > 0 and (np.diff(outline[:, 3]) >= 0).all()
    assert (outline[:-1, 2] == 0.5).all()  # a mouse with its button down

    collector.draw(OVAL)
    collector.press("k")
    until(lambda: len(read_drawings(path)), lambda kept: kept == 2, "a second drawing in the file")
    until(lambda: collector.root.locator(".sketchwidget-mode").inner_text(), lambda said: said == "2 drawings kept")
