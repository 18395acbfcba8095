"""What a pen wrote: strokes with pressure and time."""

from __future__ import annotations

from typing import Any

import numpy as np

from .stroke import REACH

MAX_PEN_POINTS = 100_000  # of a stroke: eight minutes of ink from a tablet of 200 Hz
MAX_MILLISECONDS = 1_000_000.0  # of a stroke; up to here float32 tells tenths apart

_PER_UNIT = np.array([1e5, 1e5, 1e3, 10.0])  # steps in which x, y, pressure and time are kept


def as_pen_stroke(points: Any) -> np.ndarray:
    """What a pen wrote, as a stroke with pressure and time.

    Parameters
    ----------
    points : (n, 4) array-like
        x and y in canvas units, within [-1, 2]; pressure 0..1; milliseconds since the stroke began, which never
        decrease.

    Returns
    -------
    (n, 4) float32 array
        Not writeable; rounded as it is written to files: to 1e-5, 1e-5, 1e-3 and 0.1.

    Raises
    ------
    ValueError
        If the points are anything else.
    """
    expected = f"a stroke is 1 to {MAX_PEN_POINTS:,} points, each of four numbers: x, y, pressure and milliseconds"
    try:
        array = np.asarray(points)
    except (ValueError, OverflowError) as error:  # rows of different lengths; whole numbers beyond any float
        raise ValueError(f"{expected}; given no array: {error}") from error
    if array.ndim != 2 or array.shape[1] != 4 or not 1 <= len(array) <= MAX_PEN_POINTS:
        raise ValueError(f"{expected}; given shape {array.shape}")
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{expected}; given {array.dtype} values")
    x, y, pressure, time = array.T
    low, high = REACH
    # Comparisons with NaN are false.
    on_canvas = (x >= low) & (x <= high) & (y >= low) & (y <= high)
    in_time = (time >= 0) & (np.diff(time, prepend=0) >= 0) & (time <= MAX_MILLISECONDS)
    for rule, kept in {
        f"a stroke lies within [{low:g}, {high:g}] of the canvas, the unit square": on_canvas,
        "the pressure of a pen is between 0 and 1": (pressure >= 0) & (pressure <= 1),
        f"the times of a stroke are 0 to {MAX_MILLISECONDS:,.0f} ms and never decrease": in_time,
    }.items():
        if not kept.all():
            row = int(np.argmin(kept))
            raise ValueError(f"{rule}; given {array[row].tolist()} as point {row}")
    stroke = rounded(array).astype(np.float32)
    stroke.flags.writeable = False
    return stroke


def from_tablet(points: Any) -> np.ndarray:
    """What a tablet said, as `as_pen_stroke` has it: time does not run backwards, nor is pressure beyond its bounds.

    Raises
    ------
    ValueError
        If it is no stroke all the same.
    """
    points = np.array(points, dtype=np.float64)
    points[:, 2] = points[:, 2].clip(0, 1)
    points[:, 3] = np.maximum.accumulate(points[:, 3].clip(0, MAX_MILLISECONDS))
    return as_pen_stroke(points)


def rounded(points: np.ndarray) -> np.ndarray:
    """Points (n, 4) as they are written to files: to 1e-5, 1e-5, 1e-3 and 0.1."""
    return np.round(points.astype(np.float64) * _PER_UNIT) / _PER_UNIT
