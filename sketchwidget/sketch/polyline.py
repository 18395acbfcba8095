"""Polylines: arc length and resampling by it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def arc_length(points: np.ndarray) -> np.ndarray:
    """Length along a polyline from its first point to each of its points.

    Parameters
    ----------
    points : (n, d) array
        In the plane or in space.

    Returns
    -------
    (n,) float64 array
        Starts at 0, never decreases; its last entry is the length of the polyline.
    """
    steps = np.diff(np.asarray(points, dtype=np.float64), axis=0)
    return np.concatenate([[0.0], np.cumsum(np.hypot.reduce(steps, axis=1))])


def distance(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Distance (k,) of points (k, 2) from a polyline (n, 2)."""
    start, way = line[:-1].astype(np.float64), np.diff(line.astype(np.float64), axis=0)
    off = points[:, None] - start
    share = (off * way).sum(axis=2) / np.maximum((way**2).sum(axis=1), 1e-30)
    return np.linalg.norm(off - share.clip(0.0, 1.0)[..., None] * way, axis=2).min(axis=1)


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
    return resample_each([points], n)[0]


def resample_each(lines: Sequence[np.ndarray], n: int) -> np.ndarray:
    """Polylines by `n` points each, (k, n, 2) float32; see `resample`. Thousands cost hardly more than one."""
    if n < 1:
        raise ValueError(f"a polyline is resampled to at least 1 point; given {n}")
    if not len(lines):
        return np.empty((0, n, 2), dtype=np.float32)
    points, first, last, along = one_behind_the_other(lines)
    wanted = along[first, None] + (along[last] - along[first])[:, None] * (np.arange(n) / max(n - 1, 1))
    resampled = np.stack([np.interp(wanted, along, axis) for axis in points.T], axis=2)
    if n > 1:
        resampled[:, -1] = points[last]
    return resampled.astype(np.float32)


def lengths(lines: Sequence[np.ndarray] | np.ndarray) -> np.ndarray:
    """Lengths (k,) of polylines; thousands cost hardly more than one."""
    if not len(lines):
        return np.empty(0)
    _, first, last, along = one_behind_the_other(lines)
    return along[last] - along[first]


def one_behind_the_other(
    lines: Sequence[np.ndarray] | np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Points (n, 2) of k lines, where each begins (k,) and ends (k,), and the way (n,) along all of them to each point.

    From one line to the next it is a canvas unit.
    """
    points = np.concatenate(lines).astype(np.float64)
    last = np.cumsum([len(line) for line in lines]) - 1
    first = np.concatenate([[0], last[:-1] + 1])
    steps = np.hypot(*np.diff(points, axis=0).T)
    steps[last[:-1]] = 1.0
    return points, first, last, np.concatenate([[0.0], np.cumsum(steps)])
