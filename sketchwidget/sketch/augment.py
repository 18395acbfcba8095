"""Random variants of a sketch: lines removed and deformed, after Yu et al., "Sketch me that shoe", 2016."""

from __future__ import annotations

import cv2
import numpy as np

from .moving_least_squares import affine, similarity
from .names import kind
from .polyline import arc_length, lengths, resample, resample_each
from .sketch import Segment, Sketch

_RANK = {"silhouette": 0, "feature": 1, "unnamed": 1, "wrinkle": 2}  # the order in which people draw a face
_LONG = 0.2  # canvas units: a line of this length moves half as far as a short one
_FLAT = 1e-4  # area of a hull over its extent squared
_CONTROLS = 8  # about the whole drawing; more would crumple its outline


def remove_lines(
    sketch: Sketch, random: np.random.Generator, share: float = 0.2, order: float = 2.0, length: float = 2.0
) -> Sketch:
    """A sketch without some of its segments: rather late ones than early ones, rather short ones than long ones.

    People begin with the outline and add detail, so that what comes late and is short says least about the drawing. A
    segment goes with a probability proportional to ``exp(order * o - length * l)``, one after the other; `o` is its
    place in the drawing, from 0 to 1, where wrinkles come after all features and these after the silhouette, and `l`
    is its length as a share of the longest.

    Parameters
    ----------
    sketch : Sketch
    random : numpy Generator
    share : float
        Of the segments, how many go: between 0 and 1.
    order, length : float
        How much place and length weigh (the paper's alpha and beta).

    Returns
    -------
    Sketch
        What stays is unchanged and in its order.

    Raises
    ------
    ValueError
        If the share is not between 0 and 1.
    """
    if not 0 <= share <= 1:
        raise ValueError(f"the share of the lines that go is between 0 and 1; given {share}")
    count = round(share * len(sketch))
    if not count:
        return sketch
    ranks = [_RANK[kind(segment.name)] for segment in sketch.segments]
    place = np.argsort(np.argsort(ranks, kind="stable")) / max(len(sketch) - 1, 1)
    lengths = np.array([arc_length(segment.points)[-1] for segment in sketch.segments])
    logits = order * place - length * lengths / max(lengths.max(), 1e-9)
    # The largest of the logits with Gumbel noise are a draw without replacement.
    gone = set(np.argsort(logits + random.gumbel(size=len(sketch)))[-count:].tolist())
    return Sketch(tuple(segment for i, segment in enumerate(sketch.segments) if i not in gone))


def deform_lines(sketch: Sketch, random: np.random.Generator, local: float = 0.004, overall: float = 0.012) -> Sketch:
    """A sketch with each segment bent a little, and then all of it together.

    Each segment follows its ends and its middle by moving least squares. Their noise falls with the segment's length
    and with its curvature, taken as the distance of the ends over the length: a short straight line strays the
    furthest, a closed one keeps its shape. Then the whole drawing follows points on its convex hull likewise.

    Parameters
    ----------
    sketch : Sketch
    random : numpy Generator
    local : float
        Standard deviation, in canvas units, for the ends and the middle of a very short and straight segment.
    overall : float
        Standard deviation, in canvas units, for the points on the hull.

    Returns
    -------
    Sketch
        The same names and numbers of points; what was closed is closed.
    """
    lines = [segment.points for segment in sketch.segments]
    if lines:
        lines = _warped(_bent(lines, local, random), overall, random)
    return Sketch(tuple(Segment(old.name, line) for old, line in zip(sketch.segments, lines, strict=True)))


def _bent(lines: list[np.ndarray], amount: float, random: np.random.Generator) -> list[np.ndarray]:
    """Lines that follow each its ends and its middle, which move."""
    noise = random.normal(0.0, amount, (len(lines), 3, 2))
    controls, length = resample_each(lines, 3).astype(np.float64), lengths(lines)
    across = np.linalg.norm(controls[:, 2] - controls[:, 0], axis=1)
    move = across / np.maximum(length, 1e-12) / (1 + length / _LONG)
    moved = controls + np.where(length > 0, move, 1.0)[:, None, None] * noise
    counts = [len(line) for line in lines]
    apart = np.repeat((across > 0) & (length > 0), counts)
    points, of = np.concatenate(lines).astype(np.float64), np.repeat(np.arange(len(lines)), counts)
    dots = np.repeat(length == 0, counts)
    points[dots] += noise[of[dots], 0]
    points[apart] = similarity(points[apart], controls[of[apart]], moved[of[apart]])
    return np.split(points, np.cumsum(counts)[:-1])


def _warped(lines: list[np.ndarray], amount: float, random: np.random.Generator) -> list[np.ndarray]:
    """Lines deformed together by a few points, evenly about their convex hull, that move."""
    noise = random.normal(0.0, amount, (_CONTROLS, 2))
    points = np.concatenate(lines)
    hull = cv2.convexHull(points.astype(np.float32))[:, 0]
    if cv2.contourArea(hull) <= _FLAT * np.ptp(hull, axis=0).max() ** 2:
        return lines  # one straight line or dot has no inside to warp
    controls = resample(np.concatenate([hull, hull[:1]]), _CONTROLS + 1)[:-1].astype(np.float64)
    warped = affine(points, controls, controls + noise)
    return np.split(warped, np.cumsum([len(line) for line in lines])[:-1])
