"""Erasing as in a standard sketching program: the ink under the eraser goes, and strokes split where it passed.

A place on a stroke is "index of the vertex + fraction of the edge after it". The eraser covers spans of places; what
their union leaves free are the fragments: their vertices stay as they were drawn, their ends lie on the eraser's rim.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from .names import UNNAMED
from .polyline import arc_length, resample
from .sketch import Segment, Sketch
from .stroke import as_stroke
from .sweep import covered_spans, distance_to_move

RADIUS_RANGE = (1e-3, 1.0)  # from a quarter of a pixel of the networks' image to the whole canvas

_SHORTEST = 0.5  # of the radius: shorter fragments are crumbs and go too
_TIE = 1e-3  # canvas units, a pixel of a small pad
_TOUCH = 1 - 1e-3  # of the radius: ink further out only touches the eraser, as do the ends that an earlier pass left


def erase(sketch: Sketch, path: Any, radius: float) -> Sketch:
    """The sketch without the ink under an eraser.

    A stroke that the eraser crosses becomes the fragments outside it, cut exactly at its rim, in the stroke's place in
    the drawing order and with its name; fragments shorter than half the radius go too.

    Parameters
    ----------
    sketch : Sketch
    path : (n, 2) array-like
        Where the eraser's centre went, in canvas coordinates; one point is a click.
    radius : float
        Of the eraser, in canvas units, from 0.001 to 1.

    Returns
    -------
    Sketch
        The same object if nothing is under the eraser.

    Raises
    ------
    ValueError
        If the path is no stroke, the radius is out of range, or the fragments are more than a sketch holds.
    """
    radius = as_radius(radius)
    fragments = {}
    for index, spans in _erased_spans(sketch, path, radius).items():
        name, points = sketch.segments[index].name, sketch.segments[index].points
        fragments[index] = [Segment(name, part) for part in _fragments(points, spans, radius)]
    if not fragments:
        return sketch
    return Sketch(tuple(piece for i, whole in enumerate(sketch.segments) for piece in fragments.get(i, [whole])))


def erase_stroke(points: np.ndarray, path: Any, radius: float) -> list[np.ndarray] | None:
    """The fragments of one stroke that an eraser leaves, as `erase` does it; None if the stroke is not under it.

    Parameters
    ----------
    points : (n, d) array
        Canvas coordinates, then what else each point has, as pressure and time: it is interpolated where the stroke is
        cut.
    path : (n, 2) array-like
    radius : float

    Raises
    ------
    ValueError
        If the path is no stroke or the radius is out of range.
    """
    radius = as_radius(radius)
    erased = _erased_spans(Sketch((Segment(UNNAMED, points[:, :2]),)), path, radius)
    return _fragments(points, erased[0], radius) if erased else None


def first_touched(sketch: Sketch, path: Any, radius: float) -> int | None:
    """Which segment an eraser comes to first, the nearest of several at once; None if none is under it.

    Raises
    ------
    ValueError
        If the path is no stroke or the radius is out of range.
    """
    radius = as_radius(radius)
    hit = list(_erased_spans(sketch, path, radius))
    if not hit:
        return None
    path = as_stroke(path)
    steps = resample(path, 1 + int(2 * arc_length(path)[-1] / radius))
    away = np.stack([_distance(steps, sketch.segments[index].points) for index in hit])
    first = int(np.argmax((away <= max(radius, away.min())).any(axis=0)))
    # Lines that meet are equally near where they do: then the path as a whole tells which one is meant.
    close = np.flatnonzero(away[:, first] <= away[:, first].min() + _TIE)
    return hit[int(close[np.argmin(away[close].mean(axis=1))])]


def _distance(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Distance (n,) of points (n, 2) from a polyline (m, 2)."""
    edges = np.stack([line[:-1], line[1:]], axis=1) if len(line) > 1 else np.stack([line, line], axis=1)
    return np.min([distance_to_move(points, start, end) for start, end in edges.astype(np.float64)], axis=0)


def as_radius(radius: Any) -> float:
    """The radius of an eraser or a brush as a float.

    Raises
    ------
    ValueError
        If it is no number from 0.001 to 1.
    """
    low, high = RADIUS_RANGE
    is_number = isinstance(radius, int | float | np.number) and not isinstance(radius, bool | np.complexfloating)
    if not (is_number and low <= radius <= high):
        raise ValueError(f"the radius is a number from {low:g} to {high:g} canvas units; given {radius!r}")
    return float(radius)


def _erased_spans(sketch: Sketch, path: Any, radius: float) -> dict[int, np.ndarray]:
    """The places (k, 2), from and to, that the eraser covers on each segment it hits; they may overlap."""
    path = as_stroke(path).astype(np.float64)
    if not sketch.segments:
        return {}
    owners, vertices, origins, steps = _edges(sketch)
    middles, reach = origins + steps / 2, np.hypot(*steps.T) / 2 + radius
    edges, spans, deep = [], [], []
    for start, end, near in _moves(path, np.arange(len(reach)), middles, reach):
        covered, span = covered_spans(origins[near], steps[near], start, end, radius)
        covered = near[covered]
        inside = origins[covered] + span.mean(axis=1, keepdims=True) * steps[covered]
        deep.append(distance_to_move(inside, start, end) < _TOUCH * radius)
        edges.append(covered)
        spans.append(span)
    if not edges:
        return {}
    edges = np.concatenate(edges)
    places = vertices[edges, None] + np.concatenate(spans)
    order = np.argsort(owners[edges], kind="stable")
    hit = np.unique(owners[edges[np.concatenate(deep)]])
    groups = zip(*(np.searchsorted(owners[edges[order]], hit, side) for side in ("left", "right")), strict=True)
    return {index: places[order[low:high]] for index, (low, high) in zip(hit.tolist(), groups, strict=True)}


def _moves(
    path: np.ndarray, near: np.ndarray, middles: np.ndarray, reach: np.ndarray
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Start and end (2,) of each step of a path, with the edges that have it within reach of their middle.

    The path is halved until steps are left, and each half only sees the edges near the whole: 10,000 strokes are looked
    through once, not once a step.
    """
    low, high = path.min(axis=0), path.max(axis=0)
    (x, y), r = middles[near].T, reach[near]
    near = near[(x + r >= low[0]) & (x - r <= high[0]) & (y + r >= low[1]) & (y - r <= high[1])]
    if len(path) <= 2:
        near = near[distance_to_move(middles[near], path[0], path[-1]) <= reach[near]]
        yield path[0], path[-1], near
    elif len(near):
        half = len(path) // 2
        yield from _moves(path[: half + 1], near, middles, reach)
        yield from _moves(path[half:], near, middles, reach)


def _edges(sketch: Sketch) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """All edges of a sketch: the segment (n,) and the vertex in it (n,) where each begins, its origin and step (n, 2).

    A dot is an edge of no length.
    """
    counts = np.array([len(segment.points) for segment in sketch.segments])
    points = np.concatenate([segment.points for segment in sketch.segments]).astype(np.float64)
    owners = np.repeat(np.arange(len(counts)), counts)
    last = np.cumsum(counts)[owners] - 1
    index = np.arange(len(points))
    begins = (index < last) | (counts[owners] == 1)
    steps = points[np.minimum(index + 1, last)] - points
    vertices = index - (last - counts[owners] + 1)
    return owners[begins], vertices[begins], points[begins], steps[begins]


def _fragments(points: np.ndarray, spans: np.ndarray, radius: float) -> list[np.ndarray]:
    parts = _without_spans(points, spans)
    return [part for part in parts if arc_length(part[:, :2])[-1] >= _SHORTEST * radius]


def _without_spans(points: np.ndarray, spans: np.ndarray) -> list[np.ndarray]:
    """The parts of a polyline, in order, that spans of its places leave free."""
    spans = spans[np.argsort(spans[:, 0])]
    free_until = np.append(spans[:, 0], max(1, len(points) - 1))
    free_from = np.maximum.accumulate(np.append(0.0, spans[:, 1]))
    free = np.flatnonzero(free_from < free_until)
    return [_between(points, low, high) for low, high in zip(free_from[free], free_until[free], strict=True)]


def _between(points: np.ndarray, low: float, high: float) -> np.ndarray:
    """The part (m, d) of a polyline (n, d) from one place to another."""
    index = np.arange(len(points))
    inner = points[int(low) + 1 : math.ceil(high)]
    ends = [[np.interp(place, index, points[:, k]) for k in range(points.shape[1])] for place in (low, high)]
    return np.concatenate([ends[:1], inner, ends[1:]])
