"""Which strokes of a freehand drawing are the outline of the head."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from skimage.measure import points_in_poly

from ..sketch import arc_length, resample, resample_each

_SAMPLES = 96
_SECTORS = 36
_AROUND = 0.5  # share of all directions in which an outline is seen from its middle: a jaw drawn as a U just has it
_CLOSED = 0.9
_HOLLOW = 0.2  # least over greatest distance from the middle: a scribble comes nearer
_ASPECT = (0.45, 3.0)  # height over width
_SMALLEST = 0.16  # of the canvas: what is smaller may be an eye ...
_HELD = 3  # ... unless it holds this many strokes
_SHARE = 0.25  # of the largest stroke's extent: what is smaller is neither an outline nor a piece of one
_GAP = 0.1  # of the drawing's diagonal: ends this near are one line drawn in two goes
_LONG = 0.2  # of the drawing's diagonal: shorter strokes are not joined to outlines


@dataclass(frozen=True)
class Outline:
    """The outline of a head in a drawing.

    Parameters
    ----------
    strokes : tuple of int
        Indices of the strokes that it is made of.
    points : (n, 2) array
        Along it; a U-shaped jaw is open.
    """

    strokes: tuple[int, ...]
    points: np.ndarray

    def holds(self, points: np.ndarray) -> np.ndarray:
        """Which points (n, 2) lie within it, (n,) bool."""
        return points_in_poly(points, self.points)


@dataclass(frozen=True)
class _Candidate:
    outline: Outline
    size: float
    around: float


def find_outline(strokes: Sequence[np.ndarray]) -> Outline | None:
    """The outline of the head, if one can be told.

    One stroke that goes round is taken before several that meet, the one that holds most other strokes before the
    rest, and among equals a closed one before an open one and the first drawn before later ones: so hair, ears or a hat
    drawn afterwards do not take its place.

    Parameters
    ----------
    strokes : sequence of (n, 2) arrays
        Canvas points.
    """
    extents = [float(np.ptp(stroke, axis=0).max()) for stroke in strokes]
    enough = _SHARE * max(extents, default=0.0)  # a drawing may have ten thousand strokes, but few that go round it
    large = [index for index, extent in enumerate(extents) if len(strokes[index]) > 2 and extent >= enough]
    lines = dict(zip(large, resample_each([strokes[index] for index in large], _SAMPLES), strict=True))
    single = [_candidate((index,), line) for index, line in lines.items()]
    return _best([found for found in single if found], strokes) or _best(_joined(lines), strokes)


def _candidate(indices: tuple[int, ...], line: np.ndarray) -> _Candidate | None:
    low, high = line.min(axis=0), line.max(axis=0)
    width, height = (high - low).tolist()
    if width <= 0 or not _ASPECT[0] <= height / width <= _ASPECT[1]:
        return None
    from_middle = (line - (low + high) / 2) / [width, height]
    distance = np.hypot(*from_middle.T)
    if distance.min() < _HOLLOW * distance.max():
        return None
    turned = np.arctan2(from_middle[:, 1], from_middle[:, 0]) / (2 * np.pi) % 1.0
    around = len(np.unique((turned * _SECTORS).astype(int))) / _SECTORS
    if around < _AROUND:
        return None
    # A frown is an arc too: an outline that is open is open at the top.
    if around < _CLOSED and max(line[0, 1], line[-1, 1]) > (low[1] + high[1]) / 2:
        return None
    return _Candidate(Outline(indices, line), (width * height) ** 0.5, around)


def _best(candidates: list[_Candidate], strokes: Sequence[np.ndarray]) -> Outline | None:
    rivals = {index for candidate in candidates for index in candidate.outline.strokes}
    middles = np.array([stroke.mean(axis=0) for index, stroke in enumerate(strokes) if index not in rivals])
    best, best_rank = None, (-1, False)
    for candidate in candidates:
        held = int(candidate.outline.holds(middles).sum()) if len(middles) else 0
        rank = (held, candidate.around >= _CLOSED)
        if (candidate.size >= _SMALLEST or held >= _HELD) and rank > best_rank:
            best, best_rank = candidate.outline, rank
    return best


def _joined(lines: dict[int, np.ndarray]) -> list[_Candidate]:
    """Candidates made of several long strokes whose ends meet."""
    if not lines:
        return []
    diagonal = float(np.linalg.norm(np.ptp(np.concatenate(list(lines.values())), axis=0)))
    left = {index: line for index, line in lines.items() if arc_length(line)[-1] > _LONG * diagonal}
    candidates = []
    while left:
        first = min(left)
        indices, chain = [first], left.pop(first)
        while (link := _nearest_end(chain, left, _GAP * diagonal)) is not None:
            index, chain = link
            indices.append(index)
            del left[index]
        if len(indices) > 1 and (found := _candidate(tuple(indices), resample(chain, _SAMPLES))):
            candidates.append(found)
    return candidates


def _nearest_end(chain: np.ndarray, others: dict[int, np.ndarray], reach: float) -> tuple[int, np.ndarray] | None:
    """The stroke whose end is nearest to an end of the chain, joined to it; None if none is within reach."""
    best: tuple[int, np.ndarray] | None = None
    for index, line in others.items():
        for turned in (line, line[::-1]):
            for joined, distance in (
                ((chain, turned), np.linalg.norm(chain[-1] - turned[0])),
                ((turned, chain), np.linalg.norm(turned[-1] - chain[0])),
            ):
                if distance < reach:
                    reach, best = float(distance), (index, np.concatenate(joined))
    return best
