"""The freehand drawings in docs/freehand beside the heads that they give: front and three-quarter.

python docs/contact_sheet.py
"""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from skimage.io import imsave

import sketchwidget as sw
from sketchwidget.sketch import COLOURS, kind

FOLDER = Path(__file__).parent
SIZE, COLUMNS = 260, 3
VIEWS = ("front", "three-quarter")


def drawing(sketch: sw.Sketch, names: tuple[str, ...]) -> np.ndarray:
    """The strokes in the colours of what they were taken for, (SIZE, SIZE, 3) uint8."""
    paper = np.full((SIZE, SIZE, 3), 255, dtype=np.uint8)
    for name, segment in zip(names, sketch.segments, strict=True):
        color = tuple(bytes.fromhex(COLOURS[kind(name)].removeprefix("#")))
        points = np.round(segment.points * SIZE * 16).astype(np.int32)
        cv2.polylines(paper, [points], False, color, 1, cv2.LINE_AA, 4)
    return paper


def main() -> None:
    """Write `freehand.png` beside this file."""
    regressor = sw.FaceRegressor.load()
    tiles = []
    for path in sorted((FOLDER / "freehand").glob("*.json")):
        sketch = sw.Sketch.load(path)
        result = regressor.infer(sketch)
        tiles.append(np.hstack([drawing(sketch, result.names), *(result.face.picture(view, SIZE) for view in VIEWS)]))
    rows = [np.hstack(tiles[start : start + COLUMNS]) for start in range(0, len(tiles), COLUMNS)]
    imsave(FOLDER / "freehand.png", np.vstack(rows), check_contrast=False)


if __name__ == "__main__":
    main()
