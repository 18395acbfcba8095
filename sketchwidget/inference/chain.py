"""Which point of a drawn line is which: by the shares of its length, once its strokes are put one behind the other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.distance import cdist

from ..sketch.polyline import one_behind_the_other, resample

_OVERLAP = 0.2  # share of a line that neighbouring strokes of it may both cover
_MISSING = 0.25  # share of a line at its end that may lie beyond what is drawn before it counts as not drawn
_SPANNED = 0.3  # share of a line from where its first stroke begins to where its last one ends, at least
_CLOSED = 0.25  # of the extent of a stroke: the most that may part the ends of a closed one
_FINE = 4  # points of a closed stroke for each point of its line


def in_order(strokes: Sequence[np.ndarray], line: np.ndarray) -> np.ndarray | None:
    """Strokes as one (m, 2), in the order and the direction of a line (k, 2) beside which they lie.

    None where nobody knows which of their points are which: they are drawn over each other, or a stroke comes back.
    """
    share = _shares(line)
    ends = np.concatenate([stroke[[0, -1]] for stroke in strokes])
    at = share[cdist(ends, line, "sqeuclidean").argmin(axis=1)].reshape(-1, 2)
    order, low, high = at.sum(axis=1).argsort(kind="stable"), at.min(axis=1), at.max(axis=1)
    over = (low[order[1:]] < high[order[:-1]] - _OVERLAP).any()
    if over or high.max() - low.min() < _SPANNED or any(is_closed(stroke) for stroke in strokes):
        return None
    return np.concatenate([strokes[k] if at[k, 0] <= at[k, 1] else strokes[k][::-1] for k in order])


class Chains:
    """What is drawn of some lines, each in its order and direction.

    Parameters
    ----------
    drawn : sequence of (m, 2) arrays
    """

    def __init__(self, drawn: Sequence[np.ndarray]) -> None:
        self._points, self._first, self._last, self._way = one_behind_the_other(drawn)

    def along(self, lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The points for those of lines (c, k, 2) at equal shares of the length, and which of them are drawn (c, k).

        What begins or ends within a quarter of a line's length from its end is taken to reach it: people draw brows
        shorter than they are. Beyond, the rest of the line is not drawn.
        """
        share = _shares(lines)
        ends = self._points[np.stack([self._first, self._last], axis=1)]
        nearest = np.square(ends[:, :, None] - lines[:, None]).sum(axis=3).argmin(axis=2)
        start, end = np.take_along_axis(share, nearest, axis=1).T[..., None]
        start, end = np.where(start > _MISSING, start, 0.0), np.where(end < 1 - _MISSING, end, 1.0)
        whole = end - start < _SPANNED  # the line lies elsewhere
        start, end = np.where(whole, 0.0, start), np.where(whole, 1.0, end)
        within = (share - start) / (end - start)
        length = self._way[self._last] - self._way[self._first]
        wanted = self._way[self._first, None] + within.clip(0.0, 1.0) * length[:, None]
        return _at(wanted, self._way, self._points), (within > -1e-6) & (within < 1 + 1e-6)


def is_closed(stroke: np.ndarray) -> bool:
    """Whether a stroke (m, 2) comes back to where it began; so does a dot."""
    return bool(np.linalg.norm(stroke[0] - stroke[-1]) <= _CLOSED * np.ptp(stroke, axis=0).max())


def halves(stroke: np.ndarray, axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The upper and the lower way (m, 2) round a closed stroke between its farthest points along an axis (2,)."""
    along = stroke @ axis
    first, last = int(along.argmin()), int(along.argmax())
    turned = np.roll(stroke, -first, axis=0)
    parting = (last - first) % len(stroke)
    ways = turned[: parting + 1], np.concatenate([turned[parting:], turned[:1]])[::-1]
    upper, lower = sorted(ways, key=lambda way: way[:, 1].mean())
    return upper, lower


def around(stroke: np.ndarray, line: np.ndarray) -> np.ndarray:
    """The points (k, 2) of a closed stroke for those of a closed line (k, 2), at equal shares of the length.

    It begins so that on the whole its points are where those of the line are beside it.
    """
    loop = resample(np.concatenate([stroke, stroke[:1]]), _FINE * len(line) + 1).astype(np.float64)
    if _area(loop) * _area(line) < 0:
        loop = loop[::-1]
    share = _shares(np.concatenate([line, line[:1]]))[:-1]
    beside = cdist(line, loop[:-1], "sqeuclidean").argmin(axis=1) / (len(loop) - 1)
    start = np.angle(np.exp(2j * np.pi * (beside - share)).mean()) / (2 * np.pi)
    return _at((start + share) % 1.0, np.linspace(0.0, 1.0, len(loop)), loop)


def _shares(line: np.ndarray) -> np.ndarray:
    """Of the lengths of lines (..., k, 2), how much lies before each of their points (..., k)."""
    along = np.linalg.norm(np.diff(line, axis=-2), axis=-1).cumsum(axis=-1)
    along /= np.maximum(along[..., -1:], 1e-9)
    return np.concatenate([np.zeros_like(along[..., :1]), along], axis=-1)


def _at(wanted: np.ndarray, along: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The points (..., 2) at some lengths (...) along others (n, 2)."""
    return np.stack([np.interp(wanted, along, axis) for axis in points.T], axis=-1)


def _area(loop: np.ndarray) -> float:
    """Twice the area in a loop (m, 2), negative if it runs the other way."""
    following = np.roll(loop, -1, axis=0)
    return float((loop[:, 0] * following[:, 1] - loop[:, 1] * following[:, 0]).sum())
