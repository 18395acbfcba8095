"""Edges covered by a moving disc, exactly.

A point of an edge is `origin + t step` with t from 0 to 1. A disc whose centre moves from `start` to `end` covers it
where the edge lies in the disc about one of the two ends, or in the strip between them: spans of t with closed forms.
"""

from __future__ import annotations

import numpy as np

_TINY = 1e-30  # in place of a speed of zero: what does not move meets a bound at no finite time


def covered_spans(
    origins: np.ndarray, steps: np.ndarray, start: np.ndarray, end: np.ndarray, radius: float
) -> tuple[np.ndarray, np.ndarray]:
    """The parts of edges within a distance of a straight move.

    Parameters
    ----------
    origins, steps : (n, 2) float64 arrays
        The edges; a step of zero length is a point.
    start, end : (2,) float64 arrays
        From where to where the disc moves; equal if it rests.
    radius : float
        Of the disc, in the unit of the edges.

    Returns
    -------
    edges : (k,) int array
        The edge of each span; up to three spans, which may overlap, lie on one edge.
    spans : (k, 2) float64 array
        From and to t, ascending.
    """
    spans = np.concatenate(
        [
            _span_in_disc(origins - start, steps, radius),
            _span_in_disc(origins - end, steps, radius),
            _span_in_strip(origins - start, steps, end - start, radius),
        ]
    )
    spans = np.clip(spans, 0.0, 1.0)
    some = spans[:, 0] < spans[:, 1]
    return np.tile(np.arange(len(origins)), 3)[some], spans[some]


def distance_to_move(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Distance (n,) of points (n, 2) from the nearest point between `start` and `end`."""
    offset, axis = points - start, end - start
    nearest = np.clip(offset @ axis / max(axis @ axis, _TINY), 0.0, 1.0)
    return np.hypot(*(offset - nearest[:, None] * axis).T)


def _span_in_disc(offset: np.ndarray, step: np.ndarray, radius: float) -> np.ndarray:
    """Times t (n, 2) between which |offset + t step| <= radius; equal where there are none."""
    speed = np.maximum((step * step).sum(axis=1), _TINY)
    nearest = -(offset * step).sum(axis=1) / speed
    closest = offset + nearest[:, None] * step
    half = np.sqrt(np.maximum(radius**2 - (closest * closest).sum(axis=1), 0.0) / speed)
    return np.stack([nearest - half, nearest + half], axis=1)


def _span_in_strip(offset: np.ndarray, step: np.ndarray, axis: np.ndarray, radius: float) -> np.ndarray:
    """Times t (n, 2) between which offset + t step is beside `axis` and within `radius`; descending where none."""
    length = np.hypot(*axis)
    along = axis / max(length, _TINY)
    across = np.array([-along[1], along[0]])
    beside = _span_between(offset @ along, step @ along, 0.0, length)
    within = _span_between(offset @ across, step @ across, -radius, radius)
    return np.stack([np.maximum(beside[:, 0], within[:, 0]), np.minimum(beside[:, 1], within[:, 1])], axis=1)


def _span_between(offset: np.ndarray, speed: np.ndarray, low: float, high: float) -> np.ndarray:
    """Times t (n, 2) between which low <= offset + t speed <= high."""
    speed = np.where(speed == 0, _TINY, speed)
    return np.sort(np.stack([(low - offset) / speed, (high - offset) / speed], axis=1), axis=1)
