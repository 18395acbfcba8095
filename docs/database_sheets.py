"""Contact sheets of a built database: identities, expressions, levels of exaggeration, sketches.

sketchwidget database --preset paper --out faces && python docs/database_sheets.py faces
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from skimage.io import imsave
from skimage.util import montage

import sketchwidget as sw

FOLDER = Path(__file__).parent / "database"
PEOPLE = (2, 3, 7, 12, 25, 31, 44, 52)


def sheet(pictures: list[np.ndarray], columns: int) -> np.ndarray:
    """Pictures in rows of so many columns, on white."""
    rows = -(-len(pictures) // columns)
    return montage(np.stack(pictures), grid_shape=(rows, columns), channel_axis=-1, fill=[255] * 3)


def main(path: str) -> None:
    """Write the four sheets."""
    database = sw.FaceDatabase.open(path)
    FOLDER.mkdir(exist_ok=True)

    def face(identity: int, expression: str, level: int = 1):
        return database[database.index(identity, expression, level)]

    def picture(identity: int, expression: str, level: int = 1, view: str = "front", size: int = 110) -> np.ndarray:
        return face(identity, expression, level).face.picture(view, size)

    identities = [picture(number, "neutral") for number in range(40)]
    expressions = [picture(number, name, size=84) for number in PEOPLE[:4] for name in database.expressions]
    levels = [
        picture(number, expression, level, view)
        for number in PEOPLE
        for view, expression in (("front", "neutral"), ("three-quarter", "laugh"))
        for level in (1, 2, 3, 4)
    ]
    chosen = ["neutral", "smile", "anger", "surprise", "disgust", "laugh", "shout", "cry"]
    sketches = [
        face(PEOPLE[row], name, level).sketch.picture(170) for row, level in ((0, 1), (3, 2), (6, 4)) for name in chosen
    ]
    sheets = {"identities": (identities, 10), "expressions": (expressions, 25), "levels": (levels, 8)}
    for name, (pictures, columns) in (sheets | {"sketches": (sketches, 8)}).items():
        imsave(FOLDER / f"{name}.png", sheet(pictures, columns), check_contrast=False)


if __name__ == "__main__":
    main(sys.argv[1])
