"""Gaps in the lines of a head: what an eraser opens, and how a stroke closes it (paper 3.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial import KDTree

from .crossing import cross, without_loops
from .erase import erase_stroke
from .names import SILHOUETTE
from .piece import Piece, joined
from .polyline import arc_length, resample
from .returning import without_returns

_STROKE_POINTS = 160
_JOIN = 0.02  # canvas units from an open end within which a stroke bends into the direction of the line
_GIVES_WAY = 5.0  # times its distance from an open end that a stroke bends towards it
_BACK = 2.0  # times its distance from the erased line that a stroke takes back to it
_TANGENT = 0.015  # canvas units of a line that tell its direction at an open end
_OVERSHOOT = 0.4  # of a stroke, from each end, that may run past the open end
_PAST, _PAST_SHARE = 0.03, 0.4  # canvas units at each open end, and of the erased line: what goes further means more
_ALONG = 0.3  # cosine between the ways of a stroke and of a line that it goes along
_MISSING = 0.6  # of the erased line: so much of it is drawn by a stroke that goes on, and is not just drawn elsewhere
_FARTHEST = 0.2  # canvas units from the gap: such a stroke means something else
_SHORTEST = 0.3  # of the way from end to end
_TREMOR = 0.004  # canvas units: a stroke is measured without what trembles by less
_STEADY = 0.003  # canvas units along a stroke over which a trembling hand is steadied
_LONGEST = 4.0  # times the erased line, or that way
_LEAST_OUTLINE = 0.1  # of the silhouette must stay


class GapError(ValueError):
    """A stroke that closes no gap, or an eraser that leaves nothing to join; the message says why."""


@dataclass(frozen=True, eq=False)
class Gap:
    """A part of a line that was erased and must be drawn anew.

    Parameters
    ----------
    erased : Piece
        The former line, from open end to open end.
    low, high : float
        The part of the line that the replacement stands for.
    arrival, departure : (2,) arrays or None
        Direction of the line where it breaks off and where it goes on; None where it ends: there the replacement may
        end anywhere.
    """

    erased: Piece
    low: float
    high: float
    arrival: np.ndarray | None
    departure: np.ndarray | None

    @property
    def name(self) -> str:
        """Of the line."""
        return self.erased.name

    @property
    def ends(self) -> np.ndarray:
        """The open ends (k, 2): two, one or none."""
        open_at = [end for end, way in ((0, self.arrival), (-1, self.departure)) if way is not None]
        return self.erased.points[open_at]


def feature_gap(whole: Sequence[Piece], low: float, high: float) -> tuple[list[Piece], Gap]:
    """Erase what pieces of a feature line have between two places.

    Parameters
    ----------
    whole : sequence of Piece
        All pieces of the line, in its order.
    low, high : float
        The first and the last handle point that go.

    Returns
    -------
    kept : list of Piece
    gap : Gap
    """
    before, gone, after = _parts(whole, -np.inf, low - 1), _parts(whole, low, high), _parts(whole, high + 1, np.inf)
    first = [_point_of(before[-1], -1)] if before else []
    last = [_point_of(after[0], 0)] if after else []
    return [*before, *after], Gap(
        joined([*first, *gone, *last]),
        low,
        high,
        -_direction(before[-1].points[::-1]) if before else None,
        _direction(after[0].points) if after else None,
    )


def outline_gap(whole: Piece, kept: Piece, path: Any, radius: float) -> tuple[Piece, Gap] | None:
    """Erase a part of the silhouette.

    What lies between several parts goes with them, the shorter way round.

    Parameters
    ----------
    whole : Piece
        The closed silhouette before anything of it was erased.
    kept : Piece
        What is left of it: the same, or an open part of it.
    path : (n, 2) array
        Of the eraser.
    radius : float

    Returns
    -------
    kept : Piece
    gap : Gap
        None if the eraser takes nothing away.

    Raises
    ------
    GapError
        If hardly anything would stay.
    """
    table = np.column_stack([kept.points, kept.at])
    parts = erase_stroke(table, path, radius)
    if parts is None:
        return None
    period = whole.high - whole.low
    wraps = kept.is_closed and len(parts) > 1
    if wraps and (parts[0][0] == table[0]).all() and (parts[-1][-1] == table[-1]).all():
        parts = [*parts[1:-1], np.concatenate([parts[-1], parts[0][1:] + np.array([0, 0, period])])]
    longest = max(parts, key=lambda part: arc_length(part[:, :2])[-1], default=table[:1])
    if arc_length(longest[:, :2])[-1] < _LEAST_OUTLINE * arc_length(whole.points)[-1]:
        raise GapError("hardly anything of the outline would stay: erase a part of it, the rest tells where it belongs")
    left = Piece(kept.name, longest[:, :2], longest[:, 2])
    erased = _between(whole, left.high, left.low + period)
    return left, Gap(erased, erased.low, erased.high, -_direction(left.points[::-1]), _direction(left.points))


def closed(kept: Piece, replacement: Piece) -> Piece:
    """The silhouette from what was kept of it and the replacement of the rest.

    Raises
    ------
    GapError
        If it would cross itself.
    """
    points = np.concatenate([kept.points[:-1], replacement.points[:-1], kept.points[:1]])
    at = np.concatenate([kept.at[:-1], replacement.at])
    if cross(resample(kept.points[1:-1], 200), replacement.points[2:-2]):
        raise GapError("the outline would cross itself: draw the erased part from one open end to the other")
    return Piece(kept.name, points, at)


def fill(gap: Gap, stroke: np.ndarray) -> Piece:
    """The stroke as the replacement of what was erased.

    It is turned to run the way of the line, cut where it runs past the open ends, freed of loops and of ways back along
    itself, moved onto the ends and bent into the line's direction there. Its points correspond to those of the erased
    line by arc length (5.1).

    Parameters
    ----------
    gap : Gap
    stroke : (n, 2) array

    Returns
    -------
    Piece
        From `gap.low` to `gap.high`.

    Raises
    ------
    GapError
        If the stroke is no line from end to end: a dot, a closed loop, something far away or far too long.
    """
    start, end = gap.erased.points[0].astype(np.float64), gap.erased.points[-1].astype(np.float64)
    line = _plain(gap, np.asarray(stroke, dtype=np.float64), start, end)
    if gap.arrival is not None:
        line = _begun_at(line, start, gap.arrival)
    if gap.departure is not None:
        line = _begun_at(line[::-1], end, -gap.departure)[::-1]
    # The erased points by their share of arc length, and the new ones at the same shares.
    share, along = arc_length(gap.erased.points), arc_length(line)
    at = np.interp(along / along[-1], share / share[-1], gap.erased.at)
    shares = np.unique(np.concatenate([[gap.low, gap.high], at[(at > gap.low) & (at < gap.high)]]))
    points = np.stack([np.interp(shares, at, line[:, axis]) for axis in range(2)], axis=1)
    return Piece(gap.name, points, shares)


def goes_on(gap: Gap, stroke: np.ndarray) -> bool:
    """Whether a stroke (n, 2) draws what was erased and goes on, further than a hand slips, along what was not."""
    start, end = gap.erased.points[0].astype(np.float64), gap.erased.points[-1].astype(np.float64)
    line = _oriented(resample(stroke, _STROKE_POINTS).astype(np.float64), start, end)
    past = 0.0 if gap.arrival is None else _past(line, start, gap.arrival)
    past += 0.0 if gap.departure is None else _past(line[::-1], end, -gap.departure)
    erased = float(arc_length(gap.erased.points)[-1])
    further = past > max(_PAST * len(gap.ends), _PAST_SHARE * erased)
    return bool(further and arc_length(line)[-1] - past > _MISSING * erased)


def carried_on(gap: Gap, stroke: np.ndarray) -> np.ndarray:
    """A stroke (n, 2) that is still being drawn, with what it has not come to yet as it was before it was erased.

    From the point of the erased line that is nearest to its end on, or as far along it, it bends back to that line.
    """
    former = gap.erased.points.astype(np.float64)
    if np.linalg.norm(stroke[0] - former[-1]) < np.linalg.norm(stroke[0] - former[0]):
        former = former[::-1]
    nearest = int(np.argmin(np.linalg.norm(former - stroke[-1], axis=1)))
    as_far = int(np.searchsorted(arc_length(former), arc_length(stroke)[-1]))
    left = former[min(max(nearest, as_far), len(former) - 1) :]
    off = stroke[-1] - left[0]
    share = _fading(arc_length(left), max(_BACK * float(np.linalg.norm(off)), 1e-9))
    return np.concatenate([stroke, (left + share * off)[1:]])


def _plain(gap: Gap, stroke: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The stroke as a plain line (n, 2) that runs the way of the gap."""
    chord = float(np.linalg.norm(end - start))
    if arc_length(stroke)[-1] < max(0.2 * chord, 2e-3):
        raise GapError("a dot closes no gap: draw the erased line from one end to the other")
    if _steady_length(stroke) > _LONGEST * max(float(arc_length(gap.erased.points)[-1]), chord):
        raise GapError("the stroke is far longer than the gap: draw the erased line once, from one end to the other")
    line = without_loops(without_returns(resample(stroke, _STROKE_POINTS).astype(np.float64), _TREMOR))
    if min(KDTree(gap.erased.points).query(line)[0]) > _FARTHEST:
        raise GapError("the stroke is nowhere near the gap: draw its replacement first, or put the erased line back")
    line = _oriented(line, start, end)
    if gap.arrival is not None:
        line = _cut(line, start)
    if gap.departure is not None:
        line = _cut(line[::-1], end)[::-1]
    if len(line) < 3 or np.linalg.norm(line[-1] - line[0]) < _SHORTEST * chord:
        raise GapError("a loop or a short stroke closes no gap: draw the erased line from one end to the other")
    return _steadied(resample(line, _STROKE_POINTS).astype(np.float64))


def _steadied(line: np.ndarray) -> np.ndarray:
    """A line of even steps without the tremor that no handle point could follow; its ends stay."""
    width = _STEADY * (len(line) - 1) / max(float(arc_length(line)[-1]), 1e-9)
    width = min(width, len(line) / 8)
    beyond = min(int(4 * width) + 1, len(line) - 1)
    padded = np.pad(line, ((beyond, beyond), (0, 0)), mode="reflect", reflect_type="odd")
    return gaussian_filter1d(padded, width, axis=0)[beyond : beyond + len(line)]


def _steady_length(stroke: np.ndarray) -> float:
    """The length of a stroke (n, 2) that a steady hand would have drawn."""
    length = float(arc_length(stroke)[-1])
    even = resample(stroke, 2 + int(min(length, 100.0) / _TREMOR * 2)).astype(np.float64)
    return float(arc_length(gaussian_filter1d(even, 4.0, axis=0, mode="nearest"))[-1])


def _oriented(line: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """A line (n, 2) the way round that begins and ends nearer to these points."""
    there, back = (np.linalg.norm(way[[0, -1]] - [start, end], axis=1).sum() for way in (line, line[::-1]))
    return line[::-1] if there > back else line


def _past(line: np.ndarray, end: np.ndarray, direction: np.ndarray) -> float:
    """How much of a line comes along what was not erased before its passage at an open end, from where that goes on."""
    passage = int(np.argmin(np.linalg.norm(line - end, axis=1)))
    along = _unit(line[passage] - line[0]) @ direction > _ALONG
    return float(arc_length(line)[passage]) if along else 0.0


def _cut(line: np.ndarray, end: np.ndarray) -> np.ndarray:
    """A line without what it has before its passage at an open end."""
    head = line[: max(1, int(_OVERSHOOT * len(line)))]
    return line[int(np.argmin(np.linalg.norm(head - end, axis=1))) :]


def _begun_at(line: np.ndarray, start: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """A line bent to begin at a point, and in a direction if it does not turn back; further along it stays as drawn."""
    along = arc_length(line)
    off = start - line[0]
    within = max(min(_GIVES_WAY * float(np.linalg.norm(off)), along[-1] / 2), 1e-9)
    line = line + _fading(along, within) * off
    along = arc_length(line)
    bend = int(np.searchsorted(along, min(_JOIN, along[-1] / 6)))
    onward = _unit(line[min(bend + 4, len(line) - 1)] - line[bend])
    if bend < 2 or onward @ direction < 0:
        return line
    reach = np.linalg.norm(line[bend] - start)
    t = (along[: bend + 1] / along[bend])[:, None]
    curve = (
        (2 * t**3 - 3 * t**2 + 1) * start
        + (t**3 - 2 * t**2 + t) * reach * direction
        + (3 * t**2 - 2 * t**3) * line[bend]
        + (t**3 - t**2) * reach * onward
    )
    return np.concatenate([curve, line[bend + 1 :]])


def _fading(along: np.ndarray, reach: float) -> np.ndarray:
    """Shares (n, 1) that fall smoothly from 1 at the start of a line to 0 at a length along it."""
    rest = np.clip(1 - along / reach, 0.0, 1.0)
    return (rest**2 * (3 - 2 * rest))[:, None]


def _direction(points: np.ndarray) -> np.ndarray:
    """In which direction (2,) a line (n, 2) begins."""
    along = arc_length(points)
    ahead = min(_TANGENT, along[-1])
    return _unit(np.array([np.interp(ahead, along, points[:, axis]) for axis in range(2)]) - points[0])


def _unit(vector: np.ndarray) -> np.ndarray:
    return np.asarray(vector / max(float(np.linalg.norm(vector)), 1e-12), dtype=np.float64)


def _parts(pieces: Sequence[Piece], low: float, high: float) -> list[Piece]:
    """What pieces have from one place to another; a piece that is within stays the same."""
    parts = []
    for piece in pieces:
        within = (piece.at >= low) & (piece.at <= high)
        if within.any():
            parts.append(piece if within.all() else Piece(piece.name, piece.points[within], piece.at[within]))
    return parts


def _point_of(piece: Piece, index: int) -> Piece:
    """The first or last point of a piece, as a piece."""
    return Piece(piece.name, piece.points[[index]], piece.at[[index]])


def _between(whole: Piece, low: float, high: float) -> Piece:
    """The part of the closed silhouette from one place to another, which may lie past its last point."""
    period = whole.high - whole.low
    shift = np.floor((low - whole.low) / period) * period
    at = np.concatenate([whole.at, whole.at[1:] + period]) + shift
    points = np.concatenate([whole.points, whole.points[1:]])
    places = np.concatenate([[low], at[(at > low) & (at < high)], [high]])
    return Piece(SILHOUETTE, np.stack([np.interp(places, at, points[:, axis]) for axis in range(2)], axis=1), places)
