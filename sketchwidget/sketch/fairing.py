"""Lines that a subdivided surface can have: cubic splines with a knot at every second handle point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import make_lsq_spline

from .piece import Piece, joined

_DEGREE = 3
_COARSE = 2  # handle points from one vertex of the coarse mesh to the next: a Catmull-Clark step halves its edges
HELD = 1e3  # times the weight of others that a value has which should stay


def fair(at: np.ndarray, values: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The nearest values along a line that a subdivided surface can have, by least squares.

    The handle points of a line are one step of subdivision of the vertices of a coarse mesh, which is a step towards a
    cubic spline.

    Parameters
    ----------
    at : (n,) array
        Places on the line as numbers of handle points, not descending.
    values : (n, d) array
    weights : (n,) array
        Of their squared distances.

    Returns
    -------
    (n, d) float64 array
    """
    places, first = np.unique(at, return_index=True)
    low, high = places[[0, -1]]
    inner = np.arange(low + 2 * _COARSE, high - 2 * _COARSE + 0.5, _COARSE)
    knots = np.concatenate([np.full(_DEGREE + 1, low), inner, np.full(_DEGREE + 1, high)])
    spline = make_lsq_spline(places, values[first].astype(np.float64), knots, _DEGREE, np.sqrt(weights[first]))
    return spline(at)


def faired(drawn: Piece, kept: Sequence[Piece]) -> Piece:
    """A piece that was drawn, without the kinks that no head can have; it joins the rest of its line smoothly.

    Parameters
    ----------
    drawn : Piece
    kept : sequence of Piece
        The others of its line: they stay.

    Returns
    -------
    Piece
        With its points at the same places.
    """
    line = joined(sorted([drawn, *kept], key=lambda piece: piece.low))
    new = (line.at >= drawn.low) & (line.at <= drawn.high)
    weights = np.where(new, (drawn.high - drawn.low) / len(drawn.at), HELD)
    return drawn.moved(fair(line.at, line.points, weights)[new])
