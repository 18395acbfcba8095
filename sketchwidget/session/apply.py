"""An event applied to a state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sketchwidget.sketch import UNNAMED, Sketch, erase

from . import followup
from .events import Clear, Draw, Erase, Event, Mode, StartFromTemplate
from .modeller import Modeller
from .state import State


def apply(state: State, event: Event, modeller: Modeller) -> State:
    """The state after an edit; pure, given the modeller.

    Parameters
    ----------
    state : State
    event : Event
    modeller : Modeller
        Asked for the head on show by what needs one: entering the follow-up mode, for instance.

    Returns
    -------
    State
        The same object if the edit changes nothing.

    Raises
    ------
    ValueError
        If the edit cannot be done; the message says why.
    TypeError
        If the event is no edit: what Undo and Redo mean depends on a history.
    """
    match event:
        case Mode(mode=mode):
            return state if mode == state.mode else _switched(state, mode, modeller)
        case StartFromTemplate():
            return followup.from_template(modeller)
        case _:
            sketch = _edited(state.sketch, event)
            return state if sketch is state.sketch else replace(state, sketch=sketch)


def _switched(state: State, mode: str, modeller: Modeller) -> State:
    return followup.entered(state, modeller) if mode == "followup" else replace(state, mode=mode)


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
            raise TypeError(f"an edit is a Draw, Erase, Clear, Mode or StartFromTemplate; given {event!r}")
