"""Refusing points that are not what they should be."""

from __future__ import annotations

import numpy as np


def check_finite(points: np.ndarray, shape: tuple[int, ...], expected: str, each: str) -> None:
    """Refuse points of another shape (n, d) than expected, or of which one is not finite.

    Parameters
    ----------
    points : array
    shape : tuple of int
    expected : str
        What they should be: how the message begins.
    each : str
        What one of them is called.

    Raises
    ------
    ValueError
        The message says what was given: the shape, or the first point that is not finite.
    """
    if points.shape != shape:
        raise ValueError(f"{expected}; given shape {points.shape}")
    finite = np.isfinite(points)
    if not finite.all():  # every head is checked: looking at each row would take thirty times as long
        first = int(np.argmin(finite.all(axis=1)))
        raise ValueError(f"{expected}; given {points[first].tolist()} as {each} {first}")
