"""Lines that a subdivided surface can have (Catmull and Clark 1978)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import BSpline, make_lsq_spline

from .piece import Piece, joined

FINEST = 2  # handle points from knot to knot that a head can have
_DEGREE = 3
_HELD = 1e3  # times the weight of others that a value has which should stay
_SAMPLES = 4  # from handle point to handle point


def fair(at: np.ndarray, values: np.ndarray, held: Sequence[tuple[float, float]], spacing: int) -> BSpline:
    """The nearest curve to values along a line that the handle points of a head can be on.

    Handle points come from the vertices of a coarse mesh, half as many, by a step of subdivision, whose limit is a
    cubic spline: of the splines with a knot at every second handle point this is the nearest one by least squares.

    Parameters
    ----------
    at : (n,) array
        Places on the line as numbers of handle points, not descending.
    values : (n, d) array
    held : sequence of (float, float)
        From where to where on the line the values should stay.
    spacing : int
        Handle points from knot to knot; more than two for what a head cannot have even so.

    Returns
    -------
    BSpline
        Takes places (k,) to values (k, d).
    """
    low, high = at[0], at[-1]
    inner = np.arange(low + 2 * spacing, high - 2 * spacing + 0.5, spacing)
    knots = np.concatenate([np.full(_DEGREE + 1, low), inner, np.full(_DEGREE + 1, high)])
    places = _even(low, high)
    even = np.stack([np.interp(places, at, column) for column in values.T], axis=1)
    weights = np.ones(len(places))
    for start, end in held:
        weights[(places >= start) & (places <= end)] = _HELD
    return make_lsq_spline(places, even, knots, _DEGREE, np.sqrt(weights))


def faired(drawn: Piece, kept: Sequence[Piece], spacing: int) -> Piece:
    """A piece that was drawn, without the kinks that no head can have; it joins the rest of its line smoothly.

    Parameters
    ----------
    drawn : Piece
    kept : sequence of Piece
        The others of its line: they stay.
    spacing : int
        As of `fair`.
    """
    line = joined(sorted([drawn, *kept], key=lambda piece: piece.low))
    places = _even(drawn.low, drawn.high)
    curve = fair(line.at, line.points, [(piece.low, piece.high) for piece in kept], spacing)
    return Piece(drawn.name, curve(places), places)


def _even(low: float, high: float) -> np.ndarray:
    """Places from one to another, with all handle points between them."""
    return np.linspace(low, high, int(_SAMPLES * (high - low)) + 1)
