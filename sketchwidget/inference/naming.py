"""Names for freehand strokes: each is the line of the inferred head that it runs along."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.spatial.distance import cdist

from ..sketch import SILHOUETTE, UNNAMED, WRINKLE, lengths, resample_each
from .outline import Outline

_SAMPLES = 24
_NEAR = 0.07  # mean distance to a line, of the outline's size
_LENGTHS = (0.25, 3.0)  # a stroke's length over the line's

_BROAD = 1.35  # times the width of an eye: brows are broader
# Where ears may be drawn, in the outline's box: height of their middle, and how tall and how broad they are.
_EAR_MIDDLE, _EAR_HEIGHT, _EAR_BREADTH = (0.28, 0.8), (0.06, 0.45), 0.35
_EAR_REACH = 0.15


def whereabouts(strokes: Sequence[np.ndarray], outline: Outline) -> list[str]:
    """Where each stroke lies: "inside" the outline, beside it as an "ear" may, or "outside", as hair or a neck does."""
    points = resample_each(strokes, _SAMPLES)
    within = outline.holds(points.reshape(-1, 2)).reshape(len(strokes), _SAMPLES).mean(axis=1)
    low, high = outline.points.min(axis=0), outline.points.max(axis=0)
    box = (points - low) / (high - low)
    (x, y), (breadth, height) = box.mean(axis=1).T, np.ptp(box, axis=1).T
    beside = ((x < 0.12) | (x > 0.88)) & _within(y, _EAR_MIDDLE)
    near = np.maximum(-box[..., 0].max(axis=1), box[..., 0].min(axis=1) - 1) < _EAR_REACH
    small = (breadth < _EAR_BREADTH) & _within(height, _EAR_HEIGHT)
    places = np.where(within > 0.5, "inside", np.where(beside & near & small, "ear", "outside")).tolist()
    return ["inside" if index in outline.strokes else place for index, place in enumerate(places)]


def _within(values: np.ndarray, bounds: tuple[float, float]) -> np.ndarray:
    return (bounds[0] < values) & (values < bounds[1])


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
    distance = _distances(strokes, list(lines.values()), _NEAR * size)
    nearest = distance.argmin(axis=0)
    inner = {
        index: _Extent.of(stroke)
        for index, stroke in enumerate(strokes)
        if places[index] == "inside" and index not in outline.strokes
    }
    by_place = _nose(inner, lines) | _eyes_and_brows(inner, lines, "left") | _eyes_and_brows(inner, lines, "right")
    if not any("mouth" in names[nearest[index]] and np.isfinite(distance[:, index]).any() for index in inner):
        by_place |= _mouth({index: stroke for index, stroke in inner.items() if index not in by_place}, lines, outline)

    def name(index: int) -> str:
        if index in outline.strokes:
            return SILHOUETTE
        if places[index] == "outside":
            return UNNAMED
        best = nearest[index]
        near = names[best] if np.isfinite(distance[best, index]) else WRINKLE
        # Its place tells more than the nearest line: people draw eyes higher than they are.
        return by_place.get(index, near) if near == WRINKLE or "eye" in near or "brow" in near else near

    return tuple(name(index) for index in range(len(strokes)))


def _distances(strokes: Sequence[np.ndarray], lines: Sequence[np.ndarray], reach: float) -> np.ndarray:
    """Mean distances (m, n) of n strokes from m lines; inf beyond `reach`, and where lengths do not go together."""
    distance = np.full((len(lines), len(strokes)), np.inf)
    points = resample_each(strokes, _SAMPLES)
    ratio = lengths(strokes) / lengths(lines)[:, None]
    # No mean distance is less than that of the stroke's middle from the line's box: most strokes go no further.
    middle = points.mean(axis=1)
    low, high = np.array([line.min(axis=0) for line in lines]), np.array([line.max(axis=0) for line in lines])
    off = np.linalg.norm(middle - np.clip(middle, low[:, None], high[:, None]), axis=2)
    rivals = (off < reach) & (ratio >= _LENGTHS[0]) & (ratio <= _LENGTHS[1])
    for number, line in enumerate(resample_each(lines, 2 * _SAMPLES)):
        apart = cdist(points[rivals[number]].reshape(-1, 2), line)
        distance[number, rivals[number]] = apart.min(axis=1).reshape(-1, _SAMPLES).mean(axis=1)
    distance[distance >= reach] = np.inf
    return distance


@dataclass(frozen=True)
class _Extent:
    """Where a stroke is, and how large."""

    x: float
    y: float
    width: float
    height: float
    closed: bool
    ends: tuple[list[float], list[float]]

    @classmethod
    def of(cls, stroke: np.ndarray) -> _Extent:
        x, y = stroke.mean(axis=0).tolist()
        width, height = np.ptp(stroke, axis=0).tolist()
        first, last = stroke[[0, -1]].tolist()
        closed = math.dist(first, last) < 0.3 * math.hypot(width, height) or len(stroke) == 1
        return cls(x, y, width, height, closed, (first, last))

    def meets(self, other: _Extent) -> bool:
        """Whether both end where the other does, as the lids of an eye: either way, within a quarter of their width."""
        apart = min(max(map(math.dist, self.ends, ends)) for ends in (other.ends, other.ends[::-1]))
        return apart < 0.25 * min(self.width, other.width)


def _eyes_and_brows(strokes: Mapping[int, _Extent], lines: Mapping[str, np.ndarray], side: str) -> dict[int, str]:
    """Names of the strokes about one eye: a closed one, or two whose ends meet, is the eye; the brow is above it.

    Brows too may be two strokes whose ends meet: of several such pairs the lowest is the eye, and one that is broad is
    none if anything is below it.
    """
    upper, brow = lines[f"{side}_eye_upper"], lines[f"{side}_brow"]
    middle, width = upper.mean(axis=0), float(np.ptp(upper[:, 0]))
    top = brow[:, 1].mean() - 1.2 * width
    about = {
        index: stroke
        for index, stroke in strokes.items()
        if abs(stroke.x - middle[0]) < 0.7 * width
        and top < stroke.y < middle[1] + 0.9 * width
        and stroke.width < 2.2 * width
    }
    groups: list[tuple[int, ...]] = [(index,) for index, stroke in about.items() if stroke.closed]
    groups += [pair for pair in combinations(about, 2) if about[pair[0]].meets(about[pair[1]])]
    if not groups and len(about) < 2:
        return {}
    lowest = max((stroke.y for stroke in about.values()), default=0.0)
    levels = {group: sum(about[index].y for index in group) / len(group) for group in groups}
    eye = max(levels, key=lambda group: levels[group], default=())
    if eye and max(about[index].width for index in eye) > _BROAD * width and lowest > levels[eye] + 0.3 * width:
        eye = ()
    level = levels.get(eye, lowest)
    names = {}
    for index, stroke in about.items():
        if index not in eye and stroke.y < level - 0.3 * width:
            names[index] = f"{side}_brow"
        else:
            names[index] = f"{side}_eye_{'lower' if stroke.y > level + 0.02 * width else 'upper'}"
    return names


def _nose(strokes: Mapping[int, _Extent], lines: Mapping[str, np.ndarray]) -> dict[int, str]:
    """Strokes that stand where a nose does: between the eyes and the mouth, in the middle."""
    nose = lines["nose"]
    width, middle = float(np.ptp(nose[:, 0])), float(nose[:, 0].mean())
    eyes = float(np.mean([lines[f"{side}_eye_lower"][:, 1].mean() for side in ("left", "right")]))
    mouth = float(lines["mouth_upper"][:, 1].min())
    return {
        index: "nose"
        for index, stroke in strokes.items()
        if abs(stroke.x - middle) < 0.6 * width
        and eyes < stroke.y < 0.3 * nose[:, 1].max() + 0.7 * mouth
        and 0.3 * width < math.hypot(stroke.width, stroke.height) < 3 * width
    }


def _mouth(strokes: Mapping[int, _Extent], lines: Mapping[str, np.ndarray], outline: Outline) -> dict[int, str]:
    """The broadest stroke that stands where a mouth does, between nose and chin, and one that meets its ends."""
    upper, lower = lines["mouth_upper"], lines["mouth_lower"]
    width, middle = float(np.ptp(upper[:, 0])), float(upper[:, 0].mean())
    nose, chin = float(lines["nose"][:, 1].max()), float(outline.points[:, 1].max())
    there = {
        index: stroke
        for index, stroke in strokes.items()
        if abs(stroke.x - middle) < 0.3 * width
        and nose < stroke.y < (lower[:, 1].mean() + chin) / 2
        and max(stroke.height, 0.4 * width) < stroke.width < 2.5 * width
    }
    if not there:
        return {}
    broadest = max(there, key=lambda index: there[index].width)
    level = (upper[:, 1].mean() + lower[:, 1].mean()) / 2
    for index, stroke in there.items():
        if index != broadest and stroke.meets(there[broadest]):
            level = (stroke.y + there[broadest].y) / 2
            break
    else:
        index = broadest
    return {lip: f"mouth_{'lower' if there[lip].y > level else 'upper'}" for lip in (broadest, index)}
