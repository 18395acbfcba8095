"""A line that is drawn anew, as smooth as it must be for the head to obey it without a fold (paper 5.1)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sketchwidget.face.handles import LINES
from sketchwidget.geometry.regularity import normals
from sketchwidget.sketch import Piece, Sketch
from sketchwidget.sketch.gap import GapError, goes_on
from sketchwidget.sketch.piece import handle_points
from sketchwidget.sketch.polyline import distance
from sketchwidget.sketch.returning import turned_back

from .apply import apply
from .events import Draw
from .followup import pieces_of
from .state import State

if TYPE_CHECKING:
    from .modeller import Modelled, Modeller

_NEAR = 0.0024  # canvas units, 0.6 mm of a head as it stands: how near to its lines it must be
_NO_FURTHER = 1.2  # times what it was, for a line that the head was off before
_ANOTHER = 0.022  # canvas units from the finest: such a line is not smoother, but another than was drawn
_BESIDE, _BACK = 0.03, 0.0065  # canvas units along a line within which it makes a hook, and by which it may turn back
_FOLDED = 5.0  # mm^2 of skin that may be turned over in sight: creases of lids are less, a fold that is seen is more
_SPACINGS = (2, 3, 4, 6, 8)  # handle points from knot to knot; the next where no head has the last


def obeyed(state: State, stroke: Draw, modeller: Modeller) -> tuple[Draw, State]:
    """A stroke that closes a gap, with the spacing of a line that the head has, and the state that it gives.

    Found when it is drawn, the spacing stays with the stroke: undone, done again or read from a file it is the same.

    Raises
    ------
    ValueError
        If the stroke does not close the gap, goes on past it or turns back on itself, if no head is near such a line,
        or if its skin would fold.
    """
    assert state.followup is not None and state.followup.gap is not None and state.followup.before is not None
    before, gap = state.followup.before, state.followup.gap
    if goes_on(gap, stroke.points):
        raise GapError(
            "the stroke goes on far past the gap: draw only what is missing, or erase more of the line first"
        )
    name = gap.name
    line, refusal = name.replace("_", " "), ""
    former = _placed(before.sketch, name, modeller)
    asked = None
    for spacing in _SPACINGS:
        smooth = replace(stroke, spacing=spacing)
        try:
            drawn = apply(state, smooth, modeller)
        except GapError:
            if spacing == _SPACINGS[0]:
                raise
            continue
        if asked is None:
            asked = _placed(drawn.sketch, name, modeller)
            if turned_back(asked, former, _BESIDE) > _BACK:
                raise GapError(f"the line {line} would turn back on itself: draw it once, from one end to the other")
        elif _off(asked, pieces_of(drawn.sketch, name)) > _ANOTHER:
            continue
        shown = modeller.tried(drawn)
        if _turned_over(shown, modeller.head(before), modeller.skin) > _FOLDED:
            refusal = f"the skin about the line {line} would fold: draw it nearer to where it was, or with fewer turns"
            continue
        off = _off_lines(drawn.sketch, shown)
        if off.max() <= _NEAR:
            return smooth, drawn
        # What was off before may be so still: an outline that is drawn smoother than it is, for instance.
        former_off = _off_lines(before.sketch, modeller.head(before))
        if (off <= np.where(former_off > _NEAR, _NO_FURTHER * former_off, _NEAR)).all():
            return smooth, drawn
        refusal = "no head can have this line beside the others: draw it with fewer turns, or nearer to where it was"
    raise GapError(refusal)


def _placed(sketch: Sketch, name: str, modeller: Modeller) -> np.ndarray:
    """The handle points (k, 2) of a line of a sketch."""
    return handle_points(pieces_of(sketch, name), len(modeller.model.curves[name]))


def _off_lines(sketch: Sketch, shown: Modelled) -> np.ndarray:
    """How far a head is off each line (l,) of a sketch at most, in canvas units; 0 for what is near enough."""
    off = np.zeros(len(LINES))
    for number, name in enumerate(LINES):
        pieces, placed = pieces_of(sketch, name), shown.frame.project(shown.layers.drawn.curve(name))
        far = placed[np.linalg.norm(placed - handle_points(pieces, len(placed)), axis=1) > _NEAR]
        if len(far):
            off[number] = _off(far, pieces)
    return off


def _off(points: np.ndarray, pieces: list[Piece]) -> float:
    """How far points (n, 2) are off a line at most."""
    return float(np.min([distance(points, piece.points) for piece in pieces], axis=0).max())


def _turned_over(shown: Modelled, before: Modelled, skin: np.ndarray) -> float:
    """How much skin (t, 3) of a head is turned over and was seen from the front or is now, in square millimetres.

    It is turned by more than a right angle from the head before, and from the one below that only its lines deform:
    lips that an open mouth rolls out, and lids that a shut eye rolls in, are no folds.
    """
    after, was = (normals(head.layers.drawn.vertices, skin) for head in (shown, before))
    turned = ((after * was).sum(axis=0) < 0) & ((after[2] > 0) | (was[2] > 0))
    after = after[:, turned]
    folded = (after * normals(shown.layers.below.vertices, skin[turned])).sum(axis=0) < 0
    return float(np.linalg.norm(after[:, folded], axis=0).sum() / 2)
