"""Names for freehand strokes: each is the line of the inferred head that it runs along."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.spatial import KDTree

from ..sketch import SILHOUETTE, UNNAMED, WRINKLE, arc_length, resample
from .outline import Outline

_SAMPLES = 24
_NEAR = 0.07  # mean distance to a line, of the outline's size
_LENGTHS = (0.25, 3.0)  # a stroke's length over the line's

# Where ears may be drawn, in the outline's box: height of their middle, and how tall and how broad they are.
_EAR_MIDDLE, _EAR_HEIGHT, _EAR_BREADTH = (0.28, 0.8), (0.06, 0.45), 0.35
_EAR_REACH = 0.15


def whereabouts(stroke: np.ndarray, outline: Outline) -> str:
    """Where a stroke lies: "inside" the outline, beside it as an "ear" may, or "outside", as hair or a neck does."""
    points = resample(stroke, _SAMPLES)
    within = outline.holds(points)
    if within.mean() > 0.5:
        return "inside"
    low, high = outline.points.min(axis=0), outline.points.max(axis=0)
    box = (points - low) / (high - low)
    x, y = box.mean(axis=0)
    breadth, height = np.ptp(box, axis=0)
    beside = (x < 0.12 or x > 0.88) and _EAR_MIDDLE[0] < y < _EAR_MIDDLE[1]
    near = max(-box[:, 0].max(), box[:, 0].min() - 1) < _EAR_REACH
    small = breadth < _EAR_BREADTH and _EAR_HEIGHT[0] < height < _EAR_HEIGHT[1]
    return "ear" if beside and near and small else "outside"


def name_strokes(
    strokes: Sequence[np.ndarray], outline: Outline, lines: Mapping[str, np.ndarray], places: Sequence[str]
) -> tuple[str, ...]:
    """A line name for each stroke.

    Parameters
    ----------
    strokes : sequence of (n, 2) arrays
        Canvas points.
    outline : Outline
        Its strokes are the silhouette.
    lines : mapping of (k, 2) arrays
        The feature lines of the inferred head where it stands on the canvas.
    places : sequence of str
        Whereabouts of each stroke. Those outside stay unnamed, the others are wrinkles where they run along no line.
    """
    size = float(np.sqrt(np.prod(np.ptp(outline.points, axis=0))))
    names = list(lines)
    points = np.concatenate([resample(stroke, _SAMPLES) for stroke in strokes])
    near = [KDTree(resample(line, 2 * _SAMPLES)).query(points)[0] for line in lines.values()]
    distance = np.stack(near).reshape(len(names), len(strokes), _SAMPLES).mean(axis=2)
    length = np.array([arc_length(stroke)[-1] for stroke in strokes])
    ratio = length / np.array([[arc_length(line)[-1]] for line in lines.values()])
    distance[(ratio < _LENGTHS[0]) | (ratio > _LENGTHS[1])] = np.inf
    nearest = distance.argmin(axis=0)

    def name(index: int) -> str:
        if index in outline.strokes:
            return SILHOUETTE
        if places[index] == "outside":
            return UNNAMED
        best = nearest[index]
        return names[best] if distance[best, index] < _NEAR * size else WRINKLE

    return tuple(name(index) for index in range(len(strokes)))
