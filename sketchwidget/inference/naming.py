"""Names for freehand strokes: each is the line of the inferred head that it runs along."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.spatial.distance import cdist

from ..face.wrinkles import LIPS
from ..sketch import SILHOUETTE, UNNAMED, WRINKLE, lengths, resample_each
from .figures import Extent, closed_figures, extents
from .outline import Outline

_SAMPLES = 24
_NEAR, _NEAR_EARS = 0.07, 0.14  # mean distance to a line, of the outline's size
_LENGTHS = (0.1, 3.0)  # a stroke's length over the line's: it may be drawn in pieces

# Of the width of an eye: brows are broader; strokes at least so far apart are one above the other; ends this near meet;
# what belongs to an eye is no more than this broader than it.
_BROAD, _STEP, _MEETING, _MARGIN = 1.35, 0.2, 0.3, 0.1
# How far mouths are looked for above and below where the head has its own, in steps; of the outline's size.
_SHIFTS = np.linspace(-0.06, 0.06, 11)
_BROADEST = 50  # strokes of a mouth that may have teeth between them
_SMALL, _HIGHER = 0.3, 0.15  # of the nose's width: a nostril or a dot, and how far above the nose's line it may be
_MISFIT = 0.03  # mean distance from the lines of mouth and lips, of the outline's size: what is farther is none of them
# Where ears may be drawn, in the outline's box: height of their middle, and how tall and how broad they are.
_EAR_MIDDLE, _EAR_HEIGHT, _EAR_BREADTH = (0.28, 0.8), (0.06, 0.45), 0.35
_EAR_REACH = 0.16  # from the outline's box, of the outline's size: from narrow heads ears are as far as from broad ones


def whereabouts(strokes: Sequence[np.ndarray], outline: Outline) -> list[str]:
    """Where each stroke lies: "inside" the outline, beside it as an "ear" may, or "outside", as hair or a neck does."""
    points = resample_each(strokes, _SAMPLES)
    within = outline.holds(points.reshape(-1, 2)).reshape(len(strokes), _SAMPLES).mean(axis=1)
    low, high = outline.points.min(axis=0), outline.points.max(axis=0)
    box = (points - low) / (high - low)
    (x, y), (breadth, height) = box.mean(axis=1).T, np.ptp(box, axis=1).T
    beside = ((x < 0.12) | (x > 0.88)) & _within(y, _EAR_MIDDLE)
    apart = np.maximum(low[0] - points[..., 0].max(axis=1), points[..., 0].min(axis=1) - high[0])
    near = apart < _EAR_REACH * np.sqrt(np.prod(high - low))
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
        The feature lines of the inferred head, and the outer contour of its lips, where they stand on the canvas.
    places : sequence of str
        Whereabouts of each stroke. Those outside stay unnamed, and those beside the outline that run along no ear; the
        others are wrinkles where they run along no line.
    """
    size = float(np.sqrt(np.prod(np.ptp(outline.points, axis=0))))
    names = list(lines)
    points = resample_each(strokes, _SAMPLES)
    sampled = resample_each(list(lines.values()), 2 * _SAMPLES)
    ears = np.array([name.endswith("ear") for name in names])
    # Ears may be larger and higher than the head's: what goes out and comes back is hardly anything else.
    bulging = (np.array(places) == "ear") & _bulge(points, outline)
    reach = np.where(ears[:, None] & bulging, _NEAR_EARS, _NEAR)
    distance = _distances(points, sampled, reach * size)
    inner = {
        index: stroke
        for index, stroke in enumerate(extents(points))
        if places[index] == "inside" and index not in outline.strokes
    }
    lids = [line for line, name in enumerate(names) if "eye" in name or "brow" in name]
    mouth = [line for line, name in enumerate(names) if "mouth" in name]
    steep = [index for index, stroke in inner.items() if stroke.steep]
    if np.isfinite(distance[np.ix_(lids, [index for index in inner if index not in steep])]).any():
        distance[np.ix_(lids, steep)] = np.inf
    best = distance.argmin(axis=0)
    near = [names[line] if distance[line, index] < np.inf else WRINKLE for index, line in enumerate(best)]
    drawn = [index for index, place in enumerate(places) if place != "outside" and index not in outline.strokes]
    oral = [index for index in drawn if "mouth" in near[index] or near[index] in LIPS]
    if oral:
        found = _mouth_and_lips(points[oral], dict(zip(names, sampled, strict=True)), size)
        for index, along in zip(oral, found, strict=True):
            near[index] = along if np.isfinite(distance[mouth, index]).any() else WRINKLE
    others = {index: stroke for index, stroke in inner.items() if index not in oral}
    by_place = _nose(others, lines) | _eyes_and_brows(inner, lines, "left") | _eyes_and_brows(inner, lines, "right")
    if not any("mouth" in near[index] for index in inner):
        by_place |= _mouth({index: stroke for index, stroke in inner.items() if index not in by_place}, lines, outline)

    def name(index: int) -> str:
        if index in outline.strokes:
            return SILHOUETTE
        if places[index] == "outside":
            return UNNAMED
        along = near[index]
        if places[index] == "ear" and not along.endswith("ear"):
            return UNNAMED
        # Its place tells more than the nearest line: people draw eyes higher than they are.
        return by_place.get(index, along) if along == WRINKLE or "eye" in along or "brow" in along else along

    return tuple(name(index) for index in range(len(strokes)))


def _bulge(points: np.ndarray, outline: Outline) -> np.ndarray:
    """Which strokes (n, k, 2) have both ends nearer to the middle of an outline than the rest of them is, (n,) bool."""
    low, high = outline.points.min(axis=0), outline.points.max(axis=0)
    out = np.abs(points[..., 0] - (low[0] + high[0]) / 2)
    return out[:, [0, -1]].max(axis=1) < (out.min(axis=1) + out.max(axis=1)) / 2


def _distances(points: np.ndarray, lines: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Mean distances (l, n) of strokes (n, k, 2) from lines (l, m, 2); inf beyond `reach` (l, n), and where lengths do
    not go together.
    """
    ratio = lengths(points) / lengths(lines)[:, None]
    # No mean distance is less than that of the stroke's middle from the line's box: most strokes go no further.
    middle, low, high = points.mean(axis=1), lines.min(axis=1)[:, None], lines.max(axis=1)[:, None]
    off = np.linalg.norm(middle - np.clip(middle, low, high), axis=2)
    rivals = (off < reach) & (ratio >= _LENGTHS[0]) & (ratio <= _LENGTHS[1])
    distances = np.full(rivals.shape, np.inf)
    for distance, line, near in zip(distances, lines, rivals, strict=True):
        if near.any():
            apart = cdist(points[near].reshape(-1, 2), line)
            distance[near] = apart.min(axis=1).reshape(-1, points.shape[1]).mean(axis=1)
    distances[distances >= reach] = np.inf
    return distances


def _mouth_and_lips(points: np.ndarray, lines: Mapping[str, np.ndarray], size: float) -> list[str]:
    """A name for each stroke (n, k, 2) that runs along the mouth or the contour of the lips.

    It is that of the nearest line, once the lines are moved to where they fit best. The contour of the lips is a
    wrinkle where a mouth is drawn within both of them; otherwise it is what stands for the mouth.
    """
    names = [name for name in lines if "mouth" in name or name in LIPS]
    there, ink = np.concatenate([lines[name][::2] for name in names]), points[:, ::2]
    # A mouth runs across: its ends tell where it is sideways.
    aside = (points[..., 0].min() + points[..., 0].max() - there[:, 0].min() - there[:, 0].max()) / 2
    apart = np.stack([_apart(ink, there + np.array([aside, size * shift]), len(names)) for shift in _SHIFTS], axis=1)
    misfit = np.average(np.minimum(apart.min(axis=2), _MISFIT * size), axis=0, weights=lengths(points))
    misfit += size * _SHIFTS**2
    apart = apart[:, misfit.argmin()]
    lips = np.array([name in LIPS for name in names])
    drawn = np.bincount(apart.argmin(axis=1), minlength=len(names)) > 0
    if not (drawn[lips].all() and drawn[~lips].any()):
        apart[:, lips] = np.inf
    along = [WRINKLE if lips[line] else names[line] for line in apart.argmin(axis=1)]
    # What a mouth has inside, between its lips and no broader, is a row of teeth.
    level, left, right = points[..., 1].mean(axis=1), points[..., 0].min(axis=1), points[..., 0].max(axis=1)
    mouth = np.flatnonzero([name != WRINKLE for name in along])
    mouth = mouth[np.argsort(left[mouth] - right[mouth])[:_BROADEST]]
    spanned = (left[mouth] <= left[:, None]) & (right[mouth] >= right[:, None])
    above, below = level[mouth] < level[:, None], level[mouth] > level[:, None]
    teeth = (spanned & above).any(axis=1) & (spanned & below).any(axis=1)
    return [WRINKLE if inside else name for name, inside in zip(along, teeth, strict=True)]


def _apart(ink: np.ndarray, lines: np.ndarray, count: int) -> np.ndarray:
    """Mean distances (n, l) of strokes (n, k, 2) from a number of lines of equally many points (p, 2) each."""
    apart = cdist(ink.reshape(-1, 2), lines)
    return apart.reshape(*ink.shape[:2], count, -1).min(axis=-1).mean(axis=1)


def _eyes_and_brows(strokes: Mapping[int, Extent], lines: Mapping[str, np.ndarray], side: str) -> dict[int, str]:
    """Names of the strokes about one eye: a closed figure is the eye with all that is within, the brow is above it.

    Brows too may be closed figures: of several the lowest is the eye, and one that is broad is none if anything is
    below it. Without such a figure the lowest of strokes one above the other is the eye. Open strokes that lead up or
    down are folds beside the nose, and what is beside or below an eye is a wrinkle.
    """
    upper, lower, brow = (lines[f"{side}_{name}"] for name in ("eye_upper", "eye_lower", "brow"))
    middle, (width, height) = upper.mean(axis=0), np.ptp(np.concatenate([upper, lower]), axis=0).tolist()
    top = brow[:, 1].mean() - 1.2 * width
    about = {
        index: stroke
        for index, stroke in strokes.items()
        if abs(stroke.x - middle[0]) < 0.7 * width
        and top < stroke.y < middle[1] + 0.9 * width
        and stroke.width < 2.2 * width
    }
    if not about:
        return {}
    figures = closed_figures(about, _MEETING * width)
    across = {index for index, stroke in about.items() if not stroke.steep}.union(*figures)
    about = {index: about[index] for index in across or about}
    levels = [stroke.y for stroke in about.values()]
    lowest = max(levels)
    eye = _eye([[about[index] for index in figure] for figure in figures], lowest, width, height)
    if eye is None and lowest - min(levels) < _STEP * width:
        return {}
    left, right, top, bottom = eye or (-np.inf, np.inf, lowest - _STEP * width, np.inf)
    level = lowest if eye is None else (top + bottom) / 2

    def name(stroke: Extent) -> str:
        beside = stroke.left < left - _MARGIN * width or stroke.right > right + _MARGIN * width
        if beside or not top <= stroke.y <= bottom:
            return f"{side}_brow" if stroke.y < level else WRINKLE
        return f"{side}_eye_{'lower' if stroke.y > level + 0.02 * width else 'upper'}"

    return {index: name(stroke) for index, stroke in about.items()}


def _eye(
    figures: list[list[Extent]], lowest: float, width: float, height: float
) -> tuple[float, float, float, float] | None:
    """Left, right, top and bottom of the eye among closed figures, no less than a given width and height: what is
    smaller is a dot or an iris.
    """
    if not figures:
        return None
    left, right, top, bottom = max(
        (
            (
                min(stroke.left for stroke in figure),
                max(stroke.right for stroke in figure),
                min(stroke.top for stroke in figure),
                max(stroke.bottom for stroke in figure),
            )
            for figure in figures
        ),
        key=lambda box: box[3],
    )
    x, y = (left + right) / 2, (top + bottom) / 2
    if right - left > _BROAD * width and lowest > y + _STEP * width:
        return None
    return min(left, x - width / 2), max(right, x + width / 2), min(top, y - height / 2), max(bottom, y + height / 2)


def _nose(strokes: Mapping[int, Extent], lines: Mapping[str, np.ndarray]) -> dict[int, str]:
    """Strokes that stand where a nose does: between the eyes and the mouth, in the middle."""
    nose = lines["nose"]
    width, middle = float(np.ptp(nose[:, 0])), float(nose[:, 0].mean())
    eyes = float(np.mean([lines[f"{side}_eye_lower"][:, 1].mean() for side in ("left", "right")]))
    mouth = float(lines["mouth_upper"][:, 1].min())
    tip = nose[:, 1].min() - _HIGHER * width
    sizes = {
        index: math.hypot(stroke.width, stroke.height)
        for index, stroke in strokes.items()
        if abs(stroke.x - middle) < 0.6 * width and eyes < stroke.y < 0.3 * nose[:, 1].max() + 0.7 * mouth
    }
    small = [index for index, size in sizes.items() if size < _SMALL * width]
    # One or two about the nose's tip are it, or its nostrils; others are freckles.
    nostrils = [index for index in small if strokes[index].y > tip] if len(small) <= 2 else []
    return {index: "nose" for index, size in sizes.items() if index in nostrils or _SMALL * width <= size < 3 * width}


def _mouth(strokes: Mapping[int, Extent], lines: Mapping[str, np.ndarray], outline: Outline) -> dict[int, str]:
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
