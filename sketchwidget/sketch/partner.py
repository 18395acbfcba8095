"""The two contours of an eye or of the mouth: they share their corners and do not cross (paper 3.2)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .fairing import fair
from .piece import Piece, joined

_SUFFIXES = {"_upper": "_lower", "_lower": "_upper"}


def partner_of(name: str) -> str | None:
    """The other contour of an eye or of the mouth; None for other lines."""
    for ending, other in _SUFFIXES.items():
        if name.endswith(ending):
            return name.removesuffix(ending) + other
    return None


def follow(partner: Sequence[Piece], former: Sequence[Piece], redrawn: Sequence[Piece], spacing: int) -> list[Piece]:
    """A contour after the other one was redrawn.

    It is taken along by the similarity of the plane that carries the former corners to the new ones. Where it would
    then cross the redrawn contour, it is laid onto it, as smoothly as a head can have it: lids and lips close.

    Parameters
    ----------
    partner, former, redrawn : sequences of Piece
        All pieces of the contour that follows, and of the other one before and after, in the order of their line.
    spacing : int
        As of `fair`.

    Returns
    -------
    list of Piece
    """
    (a, b), (c, d) = (
        [complex(*line.points[0]), complex(*line.points[-1])] for line in (joined(former), joined(redrawn))
    )
    turn = (d - c) / (b - a) if a != b else 1.0
    along, across = _in_axes(_complex(joined(redrawn).points), c, d)
    below = 1.0 if redrawn[0].name.endswith("_upper") == (d.real > c.real) else -1.0
    line = joined(partner)
    place, height = _in_axes(c + turn * (_complex(line.points) - a), c, d)
    lacking = np.maximum(below * (np.interp(place, np.maximum.accumulate(along), across) - height), 0.0)
    lacking[[0, -1]] = 0.0
    if lacking.any():
        free = [(place, place) for place in line.at[lacking == 0]]
        height += below * fair(line.at, lacking[:, None], free, spacing)(line.at)[:, 0]
    there = c + (place + 1j * height) * _unit(d - c)
    points = np.stack([np.real(there), np.imag(there)], axis=1)
    ends = np.cumsum([len(piece.points) for piece in partner])[:-1]
    moved = [piece.moved(part) for piece, part in zip(partner, np.split(points, ends), strict=True)]
    return _with_corners(moved, redrawn[0].points[0], redrawn[-1].points[-1])


def _with_corners(pieces: list[Piece], first: np.ndarray, last: np.ndarray) -> list[Piece]:
    """Pieces whose line ends at these points, to the last bit."""
    lines = [piece.points.copy() for piece in pieces]
    lines[0][0], lines[-1][-1] = first, last
    return [piece.moved(line) for piece, line in zip(pieces, lines, strict=True)]


def _in_axes(points: np.ndarray, start: complex, end: complex) -> tuple[np.ndarray, np.ndarray]:
    """How far complex points (n,) are along and across the way from start to end."""
    seen = (points - start) / _unit(end - start)
    return np.real(seen), np.imag(seen)


def _complex(points: np.ndarray) -> np.ndarray:
    return points[:, 0].astype(np.float64) + 1j * points[:, 1]


def _unit(way: complex) -> complex:
    return way / abs(way) if way else 1.0
