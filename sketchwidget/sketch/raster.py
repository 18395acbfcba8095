"""Lines as pixels."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

THICKNESS = 0.008  # of the canvas: in the 256-pixel image that the networks see, OpenCV covers three pixels

_SHIFT = 6  # fractional bits of a pixel coordinate
_FAR = 64.0  # canvas units; nearer than this nothing overflows, and no drawn line reaches so far


def rasterise(lines: Sequence[np.ndarray], size: int = 256, thickness: float = THICKNESS) -> np.ndarray:
    """Draw polylines into a square binary image of the canvas.

    Parameters
    ----------
    lines : sequence of (n, 2) arrays
        Canvas points (x right, y down); what lies off the unit square is cut away. One point gives a dot.
    size : int
        Pixels to a side, 1 to 8,192. Pixel `(row, column)` covers the square from `(column, row) / size` on.
    thickness : float
        Of the lines, in canvas units; at least one pixel is drawn.

    Returns
    -------
    (size, size) bool array
        True where there is ink.

    Raises
    ------
    ValueError
        If `size` is out of range or a point is not finite.
    """
    pieces = _in_pixels(lines, size)
    image = np.zeros((size, size), dtype=np.uint8)
    if pieces:
        cv2.polylines(image, pieces, False, 255, _width(thickness, size), cv2.LINE_8, _SHIFT)
    return image > 0


def paint(
    lines: Sequence[np.ndarray], colours: Sequence[str], size: int = 256, thickness: float = THICKNESS
) -> np.ndarray:
    """Draw polylines smoothly on white paper, each in a colour of its own, later ones over earlier ones.

    Parameters
    ----------
    lines : sequence of (n, 2) arrays
        As `rasterise` has them.
    colours : sequence of str
        One for each line, "#rrggbb".
    size, thickness
        As `rasterise` has them.

    Returns
    -------
    (size, size, 3) uint8 array

    Raises
    ------
    ValueError
        As `rasterise` does, or if there is not one colour for each line.
    """
    pieces = _in_pixels(lines, size)
    paper = np.full((size, size, 3), 255, dtype=np.uint8)
    for piece, colour in zip(pieces, colours, strict=True):
        ink = tuple(bytes.fromhex(colour.removeprefix("#")))
        cv2.polylines(paper, [piece], False, ink, _width(thickness, size), cv2.LINE_AA, _SHIFT)
    return paper


def _width(thickness: float, size: int) -> int:
    return max(1, round(thickness * size))


def _in_pixels(lines: Sequence[np.ndarray], size: int) -> list[np.ndarray]:
    """Polylines (n, 2) int32 as OpenCV draws them, in fractions of a pixel."""
    if not 1 <= size <= 8_192:
        raise ValueError(f"an image has 1 to 8,192 pixels to a side; given {size}")
    if len(lines) == 0:
        return []
    points = np.concatenate(lines)
    if not np.isfinite(points).all():
        raise ValueError("a line that is drawn has finite points; given NaN or infinity")
    half_pixel = 2 ** (_SHIFT - 1)  # OpenCV counts from the centre of the first pixel, the canvas from its corner
    pixels = np.rint(np.clip(points, -_FAR, _FAR) * (size * 2**_SHIFT) - half_pixel).astype(np.int32)
    pieces = np.split(pixels, np.cumsum([len(line) for line in lines])[:-1])
    # OpenCV draws edges only, and a dot has none.
    return [piece if len(piece) > 1 else np.repeat(piece, 2, axis=0) for piece in pieces]
