"""Which drawn points lie on which line of a face: strokes matched to projected curves, whole, split or merged."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import KDTree

from ..sketch import FEATURES, SILHOUETTE, arc_length, resample
from .shape_code import ShapeModel, split_lines

# Lines that one stroke may draw together: an ellipse is two eye contours, one line a closed mouth.
GROUPS = {
    SILHOUETTE: SILHOUETTE,
    **{name: name.removesuffix("_upper").removesuffix("_lower") for name in FEATURES},
}

_STEP = 0.004  # canvas units along a stroke
_REACH = 0.03  # canvas units: a point this far from its stroke counts half
_FARTHEST = 0.12  # beyond this it does not count
_PLACED_WHOLE = ("brow", "eye", "mouth", "ear")  # what is drawn whole if at all: its middle is that of the line
_ROUNDS = 3


def match(
    points: np.ndarray, strokes: Sequence[np.ndarray], names: Sequence[str], settled: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """The drawn point for each point of a face's lines.

    Parameters
    ----------
    points : (n, 2) array
        As `sketchwidget.inference.shape_code.sample` gives them, in the frame of the strokes.
    strokes : sequence of (k, 2) arrays
    names : sequence of str
        The line that each stroke was named after; those of other names are left out.
    settled : bool
        Whether the points are near their strokes already; otherwise each feature is moved onto its strokes first.

    Returns
    -------
    drawn : (n, 2) array
        The nearest point of a stroke with the line's name, or of its partner's; the point itself where there is none.
    weight : (n,) array
        How much it counts, from 0 to 1.
    """
    drawn, weight = points.copy(), np.zeros(len(points))
    numbered = split_lines(np.arange(len(points)))
    for group in dict.fromkeys(GROUPS.values()):
        members = [stroke for stroke, name in zip(strokes, names, strict=True) if GROUPS.get(name) == group]
        if not members:
            continue
        ink = np.concatenate([_dense(stroke) for stroke in members])
        at = np.concatenate([numbered[name] for name in numbered if GROUPS[name] == group])
        here = points[at]
        if not settled and any(part in group for part in _PLACED_WHOLE):
            here = here + _middle(ink) - _middle(here)
        distance, nearest = KDTree(ink).query(here)
        drawn[at] = ink[nearest]
        weight[at] = np.where(distance < _FARTHEST, 1 / (1 + (distance / _REACH) ** 2), 0.0)
    return drawn, weight


def shape_code(
    model: ShapeModel, points: np.ndarray, strokes: Sequence[np.ndarray], names: Sequence[str]
) -> np.ndarray:
    """Coefficients (p + q,) of a drawing's lines, from a guess of where they are.

    Parameters
    ----------
    model : ShapeModel
    points : (n, 2) array
        The guess: the lines of an inferred face in the normalised frame.
    strokes : sequence of (k, 2) arrays
        In that frame.
    names : sequence of str
    """
    code = np.zeros(model.size, dtype=np.float32)
    for turn in range(_ROUNDS):
        drawn, weight = match(points, strokes, names, settled=turn > 0)
        code = model.encode(drawn[None], weight[None])[0]
        points = model.decode(code[None])[0]
    return code


def _dense(stroke: np.ndarray) -> np.ndarray:
    return resample(stroke, max(2, int(arc_length(stroke)[-1] / _STEP) + 1)) if len(stroke) > 1 else stroke


def _middle(points: np.ndarray) -> np.ndarray:
    return (points.min(axis=0) + points.max(axis=0)) / 2
