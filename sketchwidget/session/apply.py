"""An event applied to a state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sketchwidget.sketch import UNNAMED, Sketch, erase

from .events import Clear, Draw, Erase, Event
from .state import State


def apply(state: State, event: Event) -> State:
    """The state after an edit.

    Parameters
    ----------
    state : State
    event : Draw, Erase or Clear

    Returns
    -------
    State
        The same object if the edit changes nothing.

    Raises
    ------
    ValueError
        If the sketch would hold more strokes than it can.
    TypeError
        If the event is no edit: what Undo and Redo mean depends on a history.
    """
    sketch = _edited(state.sketch, event)
    return state if sketch is state.sketch else replace(state, sketch=sketch)


def _edited(sketch: Sketch, event: Event) -> Sketch:
    match event:
        case Draw(points=points, mirror=mirror):
            drawn = sketch.with_segment(UNNAMED, points)
            image = np.stack([1 - points[:, 0], points[:, 1]], axis=1)
            return drawn.with_segment(UNNAMED, image) if mirror else drawn
        case Erase(points=points, radius=radius):
            return erase(sketch, points, radius)
        case Clear():
            return Sketch() if len(sketch) else sketch
        case _:
            raise TypeError(f"an edit is a Draw, Erase or Clear; given {event!r}")
