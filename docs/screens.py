"""Pictures of every tab of the Studio, light and dark, wide and narrow.

python docs/screens.py, after `sketchwidget models`
"""

from __future__ import annotations

import io
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import ViewportSize, sync_playwright
from screenshot import DRAWING, EMPTY, FOLDER, PICTURE, RUN

from jupyter_page import DEADLINE, launch_chromium, open_in_lab, serve, write_notebook  # isort: skip
from studio_page import StudioPage, until  # isort: skip

OUT = FOLDER / "screens"
THEMES = {"light": "JupyterLab Light", "dark": "JupyterLab Dark"}
SIZES = {"wide": (1280, 1200), "narrow": (540, 1900)}  # pixels of the window
COLOURS = 200  # of a picture, which makes it small

# By tab: its key, what is done before it is opened, and the word that it is ready.
DRAWN = f"for segment in sw.Sketch.load({str(DRAWING)!r}).segments:\n    studio.session.draw(segment.points)"
ERASED = """
studio.session.mode = "followup"
studio.session.erase(studio.session.sketch.lines["left_brow"][0][5])
"""
TABS = {
    "initial": ("i", DRAWN, ""),
    "followup": ("f", ERASED, ""),
    "refine": ("r", "studio.session.brush(studio.session.under_brush([[0.5, 0.57]], 0.03))", ""),
    "caricature": ("c", PICTURE, "The head fits"),
    "portrait": ("x", "from skimage import data\nstudio.marking.open(data.astronaut())", "The head is built in"),
}
DRESS = "theme => window.jupyterapp.commands.execute('apputils:change-theme', { theme })"


def main() -> None:
    """Write `screens/TAB-THEME-WIDTH.png` for each."""
    OUT.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = launch_chromium(playwright)
        notebook = write_notebook(Path(folder), "screens", EMPTY)
        with serve("lab", Path(folder)) as address:
            page = browser.new_page(viewport=_viewport("wide"))
            page.set_default_timeout(1000 * DEADLINE)
            open_in_lab(page, address, notebook)
            studio = StudioPage(page).wait_until_shown()
            for tab, (key, code, word) in TABS.items():
                page.evaluate(RUN, code)
                studio.head.hover()
                page.keyboard.press(key)
                until(lambda: studio.message, lambda said, word=word: said.startswith(word), word)
                for theme, name in THEMES.items():
                    page.evaluate(DRESS, name)
                    for width in SIZES:
                        page.set_viewport_size(_viewport(width))
                        page.mouse.move(0, 0)
                        page.wait_for_timeout(800)  # until all has its size
                        until(studio.turning, lambda turning: not turning)
                        _save(studio.root.screenshot(), OUT / f"{tab}-{theme}-{width}.png")
                page.set_viewport_size(_viewport("wide"))
                page.evaluate(DRESS, THEMES["light"])
        browser.close()
    print(f"{sum(path.stat().st_size for path in OUT.glob('*.png')) / 1e6:.1f} MB in {OUT}")


def _viewport(width: str) -> ViewportSize:
    return ViewportSize(width=SIZES[width][0], height=SIZES[width][1])


def _save(png: bytes, path: Path) -> None:
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    picture.quantize(COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)


if __name__ == "__main__":
    main()
