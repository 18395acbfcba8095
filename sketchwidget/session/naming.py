"""Which gesture a stroke is: told once, and kept with the stroke, so that a replay asks nobody."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sketchwidget.gesture.names import GESTURES, LINE

from .behaviours import recognised, silhouette_beside
from .events import Gesture
from .refinement import Edit

if TYPE_CHECKING:
    from .modeller import Modeller
    from .state import State

_ALONG = 0.7  # radians: what leads along a silhouette strays by less from its direction, on average


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
    name = event.tool or recognised(event.points) or modeller.gestures.classify(event.points)[0]
    if name is None and _leads_along_silhouette(event, state, modeller):
        name = LINE
    if name is None:
        raise ValueError(f"not a gesture: this stroke is none of {', '.join(GESTURES)}")
    return replace(event, name=name)


def _leads_along_silhouette(event: Gesture, state: State, modeller: Modeller) -> bool:
    if len(state.refinement.handles):
        return False
    drag = silhouette_beside(Edit.of(event, state, modeller))
    return drag is not None and drag.angle < _ALONG
