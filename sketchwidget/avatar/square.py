"""The square about a face that is worked on."""

from __future__ import annotations

import numpy as np

_ABOUT = 2.3  # breadths or heights of the landmarks to the square
_HIGHER = 0.06  # of its side: by how much more of it is above them than below


def square_about(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Upper left corner (2,) and side of the square about landmarks (68, 2), all in pixels."""
    low, high = points.min(axis=0), points.max(axis=0)
    side = _ABOUT * float((high - low).max())
    return (low + high) / 2 - side / 2 - (0, _HIGHER * side), side
