"""How fast the Studio is in JupyterLab on this machine: pen to ink, pen-up to updated head, and until it is shown.

    python -m benchmarks.browser [--strokes 30] [--delay 50]

All is measured in the page. *Ink* is from the time stamp of a pointer event to the end of the animation frame that drew
it. *Head* is from the time stamp of the pointer's release to the end of the rendering of the mesh that answers it, so
that it holds the way to the kernel and back, the inference, and the wait for a partial stroke that keeps the kernel
busy; of several meshes the last counts. What the compositor does then, usually one more frame, is in neither. *Shown*
is from running the cell, in a kernel that is idle, to a pad and a head on screen. With a delay all goes through a proxy
that takes so much longer each way, as a server far away does.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import sync_playwright

import sketchwidget as sw
from sketchwidget.face.drawing import editable
from sketchwidget.geometry import View

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "browser"))

from jupyter_page import launch_chromium, open_in_lab, serve, write_notebook
from studio_page import OVAL, StudioPage, until

from .delay import delayed

POINTER_RATE = 120.0  # samples a second, a usual pen's
LISTEN = """() => {
    window.measured = { ink: [], head: [] };
    let released = null, last = null;
    const studio = document.querySelector('.sketchwidget-studio');
    studio.addEventListener('sketchwidget:ink', ({ detail }) => {
        if (detail.since !== null) window.measured.ink.push(detail.drawn - detail.since);
    });
    const settle = () => {
        if (last !== null) window.measured.head.push(last);
        released = last = null;
    };
    studio.addEventListener('pointerdown', settle, { capture: true });
    studio.addEventListener('pointerup', (event) => (released = event.timeStamp), { capture: true });
    studio.addEventListener('sketchwidget:frame', ({ detail }) => {
        if (released !== null) last = detail.drawn - released;
    });
    window.settle = settle;
}"""


def measure(strokes: int = 30, delay: float = 0.0) -> dict[str, Any]:
    """Draw ``strokes`` strokes and measure each.

    Parameters
    ----------
    strokes : int
    delay : float
        Milliseconds that the network takes more, each way.

    Returns
    -------
    dict
        ``"ink"``, ``"head"`` and ``"followup"``, the head in follow-up sketching, each with ``"median"`` and ``"p95"``
        in milliseconds and the ``"count"`` of samples; ``"shown"`` in seconds.
    """
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        notebook = write_notebook(Path(folder), "studio", "import sketchwidget as sw\nsw.Studio()")
        browser = launch_chromium(playwright)
        with serve("lab", Path(folder)) as server, delayed(server, delay / 1000) as address:
            page = browser.new_page(viewport={"width": 1280, "height": 900})
            open_in_lab(page, address, notebook)
            started = time.perf_counter()
            studio = StudioPage(page).wait_until_shown()
            shown = time.perf_counter() - started
            _draw(studio, OVAL)  # the first stroke waits for the network to load
            page.evaluate(LISTEN)
            for number in range(strokes):
                shift = 0.1 * np.sin(number), 0.1 * np.cos(number)
                _draw(studio, 0.5 + 0.15 * (OVAL[:12] - 0.5) + shift)
            measured = page.evaluate("window.settle() || window.measured")
            measured["followup"] = _redrawn(studio, strokes)
        browser.close()
    return {name: _summary(values) for name, values in measured.items()} | {"shown": round(shown, 1)}


def _redrawn(studio: StudioPage, strokes: int) -> list[float]:
    """A piece of a brow erased and drawn anew, again and again: from each stroke's end to the head that obeys it."""
    studio.press("t")
    until(lambda: studio.message, lambda said: said.startswith("These are the lines"), "the lines of the template")
    model = sw.FaceModel.load()
    piece = editable(model.template, model.mean, View()).lines["left_brow"][0].astype(float)
    drawn = piece
    studio.page.evaluate("window.settle(); window.measured.head = []")
    for number in range(strokes):
        studio.press("e")
        studio.draw([drawn[len(drawn) // 2]])
        until(lambda: studio.message, lambda said: said.startswith("Erased."), "the word of the eraser")
        studio.press("p")
        drawn = piece - [0, 0.03 + 0.015 * np.sin(number)]
        _draw(studio, drawn)
    return studio.page.evaluate("window.settle() || window.measured.head")


def _draw(studio: StudioPage, points: np.ndarray) -> None:
    before = studio.serial
    studio.page.mouse.move(*studio.on_screen(points[0]))
    studio.page.mouse.down()
    for x, y in [studio.on_screen(point) for point in points[1:]]:
        studio.page.mouse.move(x, y)
        time.sleep(1 / POINTER_RATE)
    studio.page.mouse.up()
    serial = studio.wait_for_frame(before)
    while True:  # until no later frame comes: the first may be that of a partial stroke
        time.sleep(0.4)
        if studio.serial == serial:
            return
        serial = studio.serial


def _summary(values: list[float]) -> dict[str, float]:
    return {
        "median": round(float(np.median(values)), 1),
        "p95": round(float(np.percentile(values, 95)), 1),
        "count": len(values),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--strokes", type=int, default=30)
    parser.add_argument("--delay", type=float, default=0.0, help="milliseconds more each way")
    given = parser.parse_args()
    print(json.dumps(measure(given.strokes, given.delay), indent=2))


if __name__ == "__main__":
    main()
