"""The README's pictures of the Studio, taken in a real browser: a laughing face, drawn with the mouse; a caricature.

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
from studio_page import StudioPage, until  # noqa: E402

DRAWING = FOLDER / "freehand" / "08_laughing.json"
EMPTY = "import sketchwidget as sw\n\nstudio = sw.Studio()\nstudio"
# A picture of a head of our own, whose landmarks are known.
PICTURE = """
import numpy as np
from sketchwidget.geometry import rotation_about_y

model = sw.FaceModel.load()
head = sw.caricature.exaggerate(model.face(model.bilinear.identities[4 * 33], "smile"), 1.6)
view = sw.View(rotation_about_y(-14), 1 / 270, np.array([0.5, 0.48]))
studio.marking.open(head.picture(view, 900))
studio.marking.place(900 * view.project(head.landmarks))
"""
RUN = "code => window.jupyterapp.shell.currentWidget.sessionContext.session.kernel.requestExecute({ code }).done"


def main() -> None:
    """Write `studio.png` and `caricature_tab.png` beside this file."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = launch_chromium(playwright)
        with serve("lab", Path(folder)) as address:
            page = browser.new_page(viewport={"width": 1280, "height": 900}, device_scale_factor=1.5)
            open_in_lab(page, address, write_notebook(Path(folder), "studio", EMPTY))
            studio = StudioPage(page).wait_until_shown()
            for segment in sw.Sketch.load(DRAWING).segments:
                before = studio.serial
                studio.draw(segment.points.tolist())
                studio.wait_for_frame(before)
            studio.root.screenshot(path=FOLDER / "studio.png")

            studio.press("c")
            page.evaluate(RUN, PICTURE)
            until(lambda: studio.message, lambda said: said.startswith("The head fits"), "the fit")
            until(studio.turning, lambda turning: not turning)
            studio.root.locator(".sketchwidget-figures").evaluate("figures => figures.remove()")  # of a busy machine
            studio.root.screenshot(path=FOLDER / "caricature_tab.png")
        browser.close()


if __name__ == "__main__":
    main()
