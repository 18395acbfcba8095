"""Which gesture a stroke is: told once, and kept with the stroke, so that a replay asks nobody."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sketchwidget.gesture.names import GESTURES, LEFT_ARROW, LINE, RIGHT_ARROW
from sketchwidget.sketch import resample
from sketchwidget.sketch.polyline import arc_length

from .behaviours import recognised, silhouette_beside
from .events import Gesture
from .refinement import Edit

if TYPE_CHECKING:
    from .modeller import Modeller
    from .state import State

_STRAIGHT = 0.985  # of a line: what there is between its ends, as a share of its length; a tenth of a turn has as much
# Radians by which what leads along a silhouette strays from its direction, on average: what is no gesture otherwise,
# and what looks like an arrow, as the outline of a nose from the side. Arrows that are meant stray by 0.6 and more.
_ALONG = {None: 0.7, LEFT_ARROW: 0.3, RIGHT_ARROW: 0.3}


def named(event: Gesture, state: State, modeller: Modeller) -> Gesture:
    """The event with the name of what its stroke is: a user's own gesture, or one of the ten.

    A line need not be straight where it leads along a silhouette and no handles are marked: outlines are round.

    Raises
    ------
    ValueError
        If it is none.
    """
    if event.name is not None:
        return event
    name = event.tool or recognised(event.points)
    if name is None:
        name = modeller.gestures.classify(event.points)[0]
        if name in _ALONG and _angle_to_silhouette(event, state, modeller) < _ALONG[name]:
            name = LINE
    if name is None:
        raise ValueError(f"not a gesture: this stroke is none of {', '.join(GESTURES)}")
    return replace(event, name=name)


def may_change(event: Gesture, state: State) -> bool:
    """Whether a stroke that is still drawn, and named, may well become another gesture: a line that bends, a roll."""
    bends = np.hypot(*(event.points[-1] - event.points[0])) < _STRAIGHT * arc_length(resample(event.points, 16))[-1]
    return bool(event.name == LINE and len(state.refinement.handles) and bends)


def _angle_to_silhouette(event: Gesture, state: State, modeller: Modeller) -> float:
    """Between a stroke and the silhouette that it would drag, radians; infinite if it would drag none."""
    drag = None if len(state.refinement.handles) else silhouette_beside(Edit.of(event, state, modeller))
    return np.inf if drag is None else drag.angle
