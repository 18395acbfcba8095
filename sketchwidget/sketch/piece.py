"""Pieces of the lines of a head: segments that know which part of their line they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from .names import SILHOUETTE
from .polyline import arc_length, resample
from .sketch import Segment

_FAR = 0.06  # canvas units from a line at which handle points hardly tell their place on it
_SLIDE = 0.1  # canvas units that they slide along it at most
_DENSE = 2000


@dataclass(frozen=True, eq=False)
class Piece(Segment):
    """A segment of a line that is a sequence of handle points: the paper's point-wise correspondence (5.1).

    Parameters
    ----------
    name : str
    points : (n, 2) array
    at : (n,) array
        Where on its line each point lies, as a number of handle points from the first on; increasing. On the closed
        silhouette it may begin anywhere, and goes on past the last.

    Raises
    ------
    ValueError
        If there is not one place for each point, or they do not increase.
    """

    at: Any = None

    def __post_init__(self) -> None:
        super().__post_init__()
        at = np.array(self.at, dtype=np.float64)
        if at.shape != (len(self.points),) or not (np.diff(at) >= 0).all():
            raise ValueError(f"a piece has a place on its line for each of its {len(self.points)} points, ascending")
        at.flags.writeable = False
        object.__setattr__(self, "at", at)

    @property
    def low(self) -> float:
        """Where on its line the piece begins."""
        return float(self.at[0])

    @property
    def high(self) -> float:
        """Where on its line the piece ends."""
        return float(self.at[-1])

    @property
    def is_closed(self) -> bool:
        """Whether it is the whole silhouette."""
        return self.name == SILHOUETTE and bool((self.points[0] == self.points[-1]).all())

    def moved(self, points: np.ndarray) -> Piece:
        """The piece with its points elsewhere."""
        return Piece(self.name, points, self.at)


def joined(pieces: Sequence[Piece]) -> Piece:
    """Pieces of one line, in its order, as one; the gaps between them are bridged."""
    points = np.concatenate([piece.points for piece in pieces])
    return Piece(pieces[0].name, points, np.concatenate([piece.at for piece in pieces]))


def handle_points(pieces: Sequence[Piece], count: int) -> np.ndarray:
    """Where the handle points of a line are.

    Parameters
    ----------
    pieces : sequence of Piece
        Of one line.
    count : int
        Number of its handle points; the last of the silhouette is the first.

    Returns
    -------
    (count, 2) float64 array
        NaN for those that lie on no piece.
    """
    found = np.full((count, 2), np.nan)
    for piece in pieces:
        at = np.arange(count, dtype=np.float64)
        if piece.name == SILHOUETTE:
            at = piece.low + (at - piece.low) % (count - 1)
        on = (at >= piece.low - 1e-6) & (at <= piece.high + 1e-6)
        for axis in range(2):
            found[on, axis] = np.interp(at[on], piece.at, piece.points[:, axis])
    return found


def slid(outline: Piece, near: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Handle points of the closed silhouette, slid along it to where a head has them.

    Arc length alone tells how the points of an erased line correspond to those of the drawn one; that of a long smooth
    line says little about where on it they belong. A head that is near the drawn line already knows better.

    Parameters
    ----------
    outline : Piece
        As drawn, closed.
    near : (k, 2) array
        Handle points of a head, of which the last is the first.
    held : (k,) bool array
        Those that do not slide.

    Returns
    -------
    (k, 2) float64 array
    """
    along = arc_length(outline.points)
    length = along[-1]
    at = outline.low + (np.arange(len(near) - 1) - outline.low) % (len(near) - 1)
    place = np.interp(at, outline.at, along)
    distance, index = KDTree(resample(outline.points, _DENSE)[:-1]).query(near[:-1])
    slide = (np.asarray(index) * length / (_DENSE - 1) - place + length / 2) % length - length / 2
    slide = np.clip(slide, -_SLIDE, _SLIDE) * np.exp(-((distance / _FAR) ** 2))
    place = place + np.where(held[:-1], 0.0, slide)
    order = np.argsort(at)
    place[order] = np.maximum.accumulate(place[order])  # none overtakes another
    place %= length
    points = np.stack([np.interp(place, along, outline.points[:, axis]) for axis in range(2)], axis=1)
    return np.concatenate([points, points[:1]])
