"""Polylines: arc length and resampling by it."""

from __future__ import annotations

import math

import numpy as np


def arc_length(points: np.ndarray) -> np.ndarray:
    """Length along a polyline from its first point to each of its points.

    Parameters
    ----------
    points : (n, 2) array

    Returns
    -------
    (n,) float64 array
        Starts at 0, never decreases; its last entry is the length of the polyline.
    """
    steps = np.diff(np.asarray(points, dtype=np.float64), axis=0)
    return np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])


def resample(points: np.ndarray, n: int) -> np.ndarray:
    """A polyline by `n` points at equal distances along it; its ends stay where they are.

    Parameters
    ----------
    points : (m, 2) array
    n : int
        At least 1, which gives the first point.

    Returns
    -------
    (n, 2) float32 array

    Raises
    ------
    ValueError
        If `n` is less than 1.
    """
    if n < 1:
        raise ValueError(f"a polyline is resampled to at least 1 point; given {n}")
    points = np.asarray(points, dtype=np.float64)
    along = arc_length(points)
    wanted = np.linspace(0.0, along[-1], n)
    return np.stack([np.interp(wanted, along, points[:, k]) for k in (0, 1)], axis=1).astype(np.float32)


def resample_spacing(points: np.ndarray, step: float) -> np.ndarray:
    """A polyline by evenly spaced points, as few as keep two neighbours within `step` of each other.

    Parameters
    ----------
    points : (m, 2) array
    step : float
        In the unit of the points.

    Returns
    -------
    (n, 2) float32 array
        With both ends; one point where the polyline has no length.

    Raises
    ------
    ValueError
        If `step` is not positive.
    """
    if not step > 0:
        raise ValueError(f"the spacing of a polyline is positive; given {step}")
    return resample(points, math.ceil(arc_length(points)[-1] / step) + 1)
