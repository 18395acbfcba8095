"""The README's picture of the Studio, taken in a real browser: a laughing face, drawn with the mouse.

python docs/screenshot.py
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

import sketchwidget as sw

FOLDER = Path(__file__).parent
sys.path.insert(0, str(FOLDER.parent / "tests" / "browser"))

from jupyter_page import launch_chromium, open_in_lab, serve, write_notebook  # noqa: E402
from studio_page import StudioPage  # noqa: E402

DRAWING = FOLDER / "freehand" / "08_laughing.json"


def main() -> None:
    """Write `studio.png` beside this file."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        notebook = write_notebook(Path(folder), "studio", "import sketchwidget as sw\nsw.Studio()")
        browser = launch_chromium(playwright)
        with serve("lab", Path(folder)) as address:
            page = browser.new_page(viewport={"width": 1280, "height": 900}, device_scale_factor=1.5)
            open_in_lab(page, address, notebook)
            studio = StudioPage(page).wait_until_shown()
            for segment in sw.Sketch.load(DRAWING).segments:
                before = studio.serial
                studio.draw(segment.points.tolist())
                studio.wait_for_frame(before)
            page.locator(".sketchwidget-studio").screenshot(path=FOLDER / "studio.png")
        browser.close()


if __name__ == "__main__":
    main()
