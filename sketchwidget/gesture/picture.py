"""A stroke as the image that the network sees: moved and scaled to its middle, then drawn."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..sketch import rasterise
from ..sketch.stroke import as_points

IMAGE_SIZE = 256  # pixels a side (DeepSketch2Face, section 5.2)

_EXTENT = 0.84  # of the image, for the longer side of a stroke
_THICKNESS = 0.016  # of the image: four pixels, the stride of the first convolution


def normalised(points: Any) -> np.ndarray:
    """A stroke with its bounding box in the middle of the unit square, the longer side 0.84 long.

    Parameters
    ----------
    points : (n, 2) array-like
        In any frame, y down.

    Returns
    -------
    (n, 2) float64 array
        A stroke without extent stays one point in the middle.

    Raises
    ------
    ValueError
        If the points are no stroke.
    """
    stroke = as_points(points)
    low, high = stroke.min(axis=0), stroke.max(axis=0)
    extent = float((high - low).max())
    return 0.5 + (stroke - (low + high) / 2) * (_EXTENT / extent if extent > 0 else 0.0)


def picture(points: Any) -> np.ndarray:
    """The image (256, 256) bool of a stroke, True where there is ink; errors are those of `normalised`."""
    return rasterise([normalised(points)], IMAGE_SIZE, _THICKNESS)
