"""A line that is drawn anew, as smooth as it must be for the head to obey it (paper 5.1)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sketchwidget.face.handles import LINES
from sketchwidget.sketch import Sketch
from sketchwidget.sketch.gap import GapError
from sketchwidget.sketch.piece import handle_points
from sketchwidget.sketch.polyline import distance

from .apply import apply
from .events import Draw
from .followup import pieces_of
from .state import State

if TYPE_CHECKING:
    from .modeller import Modelled, Modeller

_NEAR = 0.0024  # canvas units, 0.6 mm of a head as it stands: how near to its lines it must be
_NO_FURTHER = 1.2  # times what it was, for a line that the head was off before
_SPACINGS = (2, 3, 4, 6, 8)  # handle points from knot to knot; the next where no head has the last


def obeyed(state: State, stroke: Draw, modeller: Modeller) -> tuple[Draw, State]:
    """A stroke that closes a gap, with the spacing of a line that the head has, and the state that it gives.

    Found when it is drawn, the spacing stays with the stroke: undone, done again or read from a file it is the same.

    Raises
    ------
    ValueError
        If the stroke does not close the gap, or no head is near such a line.
    """
    assert state.followup is not None and state.followup.before is not None
    before = state.followup.before
    for spacing in _SPACINGS:
        smooth = replace(stroke, spacing=spacing)
        try:
            drawn = apply(state, smooth, modeller)
        except GapError:
            if spacing == _SPACINGS[0]:
                raise
            continue
        off = _off_lines(drawn.sketch, modeller.tried(drawn))
        if off.max() <= _NEAR:
            return smooth, drawn
        # What was off before may be so still: an outline that is drawn smoother than it is, for instance.
        former = _off_lines(before.sketch, modeller.head(before))
        if (off <= np.where(former > _NEAR, _NO_FURTHER * former, _NEAR)).all():
            return smooth, drawn
    raise GapError("no head can have this line beside the others: draw it with fewer turns, or nearer to where it was")


def _off_lines(sketch: Sketch, shown: Modelled) -> np.ndarray:
    """How far a head is off each line (l,) of a sketch at most, in canvas units; 0 for what is near enough."""
    off = np.zeros(len(LINES))
    for number, name in enumerate(LINES):
        pieces, placed = pieces_of(sketch, name), shown.frame.project(shown.layers.drawn.curve(name))
        far = placed[np.linalg.norm(placed - handle_points(pieces, len(placed)), axis=1) > _NEAR]
        if len(far):
            off[number] = np.min([distance(far, piece.points) for piece in pieces], axis=0).max()
    return off
