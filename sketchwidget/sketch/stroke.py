"""What counts as a stroke: validation and bounds of the points that a pen, a file or a caller hands in."""

from __future__ import annotations

from typing import Any

import numpy as np

from .polyline import resample

MAX_GIVEN_POINTS = 1_000_000  # more than an hour of a 200 Hz pen tablet: no stroke
MAX_POINTS = 2_000
REACH = (-1.0, 2.0)  # a stroke may leave the pad, but not by more than the pad's own width


def as_points(points: Any) -> np.ndarray:
    """Points of any frame as an array.

    Parameters
    ----------
    points : (n, 2) array-like
        Finite real numbers, 1 to 1,000,000 points.

    Returns
    -------
    (n, 2) float64 array

    Raises
    ------
    ValueError
        If the points are anything else.
    """
    expected = f"a stroke is an array (n, 2) of finite numbers with 1 to {MAX_GIVEN_POINTS:,} points"
    try:
        array = np.asarray(points)
    except ValueError as error:
        raise ValueError(f"{expected}; given rows of different lengths") from error
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{expected}; given {array.dtype} values")
    if array.ndim != 2 or array.shape[1] != 2 or not 1 <= len(array) <= MAX_GIVEN_POINTS:
        raise ValueError(f"{expected}; given shape {array.shape}")
    array = array.astype(np.float64)
    # The negated comparison catches NaN as well, and what would overflow in float32.
    beyond = ~(np.abs(array) <= np.finfo(np.float32).max)
    if beyond.any():
        row = int(np.argwhere(beyond)[0, 0])
        raise ValueError(f"{expected}; given {array[row].tolist()} as point {row}")
    return array


def as_stroke(points: Any) -> np.ndarray:
    """Points of the canvas as a stroke.

    Parameters
    ----------
    points : (n, 2) array-like
        Canvas points, each coordinate within [-1, 2].

    Returns
    -------
    (m, 2) float32 array
        Not writeable. One point if all are equal (a dot); at most 2,000, by arc length if more were given.

    Raises
    ------
    ValueError
        If the points are no stroke, or too far off the canvas.
    """
    array = as_points(points)
    low, high = REACH
    outside = ((array < low) | (array > high)).any(axis=1)
    if outside.any():
        row = int(np.argmax(outside))
        raise ValueError(
            f"a stroke lies within [{low:g}, {high:g}] of the canvas, the unit square; "
            f"given {array[row].tolist()} as point {row}"
        )
    if (array == array[0]).all():
        array = array[:1]
    elif len(array) > MAX_POINTS:
        array = resample(array, MAX_POINTS)
    stroke = array.astype(np.float32)
    stroke.flags.writeable = False
    return stroke
