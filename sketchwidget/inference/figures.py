"""Where strokes are, how large, and which of them are one closed figure."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.cluster.hierarchy import DisjointSet
from scipy.spatial import KDTree

_PARTNERS = 12  # nearest ends that an end may meet, itself among them: in dense hatching there are thousands
_OPEN = 0.3  # of a stroke's diagonal: ends farther apart leave it open


@dataclass(frozen=True)
class Extent:
    """Where a stroke, or several, is, and how large.

    Parameters
    ----------
    x, y : float
        Mean of its points.
    left, right, top, bottom : float
    ends : (2, 2) array
    """

    x: float
    y: float
    left: float
    right: float
    top: float
    bottom: float
    ends: np.ndarray

    @property
    def width(self) -> float:
        """From left to right."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """From top to bottom."""
        return self.bottom - self.top

    @property
    def closed(self) -> bool:
        """Whether it ends about where it begins; a dot does."""
        return math.dist(*self.ends) <= _OPEN * math.hypot(self.width, self.height)

    @property
    def steep(self) -> bool:
        """Whether it leads up or down rather than across."""
        return self.height > self.width and not self.closed

    def meets(self, other: Extent) -> bool:
        """Whether both end where the other does, as two lips: either way, within a quarter of their width."""
        apart = [np.linalg.norm(self.ends - ends, axis=1).max() for ends in (other.ends, other.ends[::-1])]
        return bool(min(apart) < 0.25 * min(self.width, other.width))


def extents(points: np.ndarray) -> list[Extent]:
    """Those of strokes (n, k, 2)."""
    numbers = np.concatenate([points.mean(axis=1), points.min(axis=1), points.max(axis=1)], axis=1).tolist()
    return [
        Extent(x, y, left, right, top, bottom, ends)
        for (x, y, left, top, right, bottom), ends in zip(numbers, points[:, [0, -1]], strict=True)
    ]


def closed_figures(strokes: Mapping[int, Extent], reach: float) -> list[list[int]]:
    """Strokes by the closed figure that they are part of: each goes on where others end, and no end is loose.

    Parameters
    ----------
    strokes : mapping of Extent
    reach : float
        Ends this near meet.
    """
    if not strokes:
        return []
    closed = np.array([stroke.closed for stroke in strokes.values()], dtype=bool)
    ends = np.concatenate([stroke.ends for stroke in strokes.values()])
    partners = KDTree(ends).query(ends, _PARTNERS, distance_upper_bound=reach)[1]
    meetings = np.stack([np.repeat(np.arange(len(ends)), _PARTNERS), partners.ravel()], axis=1)
    meetings = meetings[(meetings[:, 1] < len(ends)) & (meetings[:, 0] // 2 != meetings[:, 1] // 2)]
    kept, whole = np.zeros(len(strokes), dtype=bool), np.ones(len(strokes), dtype=bool)
    while (kept != whole).any():
        kept = whole
        meetings = meetings[kept[meetings // 2].all(axis=1)]
        meets = np.repeat(closed, 2)
        meets[meetings] = True
        whole = kept & meets.reshape(-1, 2).all(axis=1)
    indices = list(strokes)
    figures = DisjointSet([indices[place] for place in np.flatnonzero(kept)])
    for one, other in (meetings // 2).tolist():
        figures.merge(indices[one], indices[other])
    return [sorted(figure) for figure in figures.subsets()]
