"""Lines that turn back along themselves."""

from __future__ import annotations

import numpy as np
from scipy.spatial.distance import cdist

_AGAINST = np.cos(np.radians(120.0))  # ways this far apart or more run against each other


def without_returns(line: np.ndarray, near: float) -> np.ndarray:
    """A polyline (n, 2) of even steps without what, at either of its ends, runs back along the rest of it.

    Parameters
    ----------
    line : (n, 2) array
    near : float
        How far from the rest that is at most.
    """
    for _ in range(2):
        step = max(float(np.linalg.norm(line[1] - line[0])), 1e-9)
        way = np.gradient(line, axis=0)
        back = (cdist(line, line) < near) & (way @ way.T < 0)
        again = np.any(np.tril(back, -int(3 * near / step) - 1), axis=1)
        line = line[: len(line) - int(np.argmin(again[::-1]))][::-1]
    return line


def turned_back(line: np.ndarray, former: np.ndarray, within: float) -> float:
    """How far a polyline runs back against the way that it ran before, where it turns back on itself.

    Each for itself is no hook: a lid that closes ends in other ways than before, and the tip of a nose turns back.

    Parameters
    ----------
    line, former : (n, 2) arrays
        Now and before, point by point.
    within : float
        How far along the line something else runs against what turns back.

    Returns
    -------
    float
        The length of these edges, seen along their former ways.
    """
    way, way_before = np.diff(line, axis=0), np.diff(former, axis=0)
    length, length_before = np.linalg.norm(way, axis=1), np.linalg.norm(way_before, axis=1)
    middle = np.cumsum(length) - length / 2
    opposed = way @ way.T < _AGAINST * np.outer(length, length)
    opposed &= np.abs(middle[:, None] - middle) < within
    back = np.maximum(-(way * way_before).sum(axis=1), 0.0) / np.maximum(length_before, 1e-12)
    return float(back[opposed.any(axis=1)].sum())
