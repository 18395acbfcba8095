"""An event applied to a state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sketchwidget.sketch import UNNAMED, Sketch, erase

from . import followup
from .behaviours import gestured
from .events import Brush, Cancel, Clear, Draw, Erase, Event, Exaggerate, Gesture, Mode, StartFromTemplate, TakeOver
from .modeller import Modeller
from .refinement import brushed, unmarked
from .state import State
from .take_over import exaggerated, taken_over


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
    after = _applied(state, event, modeller)
    # What follows an exaggeration starts from the head as it is by then.
    if after is state or after.exaggeration is None or isinstance(event, Exaggerate):
        return after
    return replace(after, exaggeration=None)


def _applied(state: State, event: Event, modeller: Modeller) -> State:
    match event:
        case Mode(mode=mode):
            return state if mode == state.mode else _switched(state, mode, modeller)
        case StartFromTemplate():
            started = followup.from_template(modeller)
            return state if _is_untouched(state, started) else started
        case TakeOver(vertices=vertices, texture=texture):
            return taken_over(modeller.face(vertices), modeller, texture)
        case Exaggerate(amount=amount):
            return exaggerated(state, amount, modeller)
        case Draw() | Erase() | Clear() | Cancel() if state.mode == "followup":
            return followup.edited(state, event, modeller)
        case Cancel():
            return state
        case Gesture():
            return gestured(_refining(state, modeller), event, modeller)
        case Brush():
            return brushed(_refining(state, modeller), event, modeller)
        case Clear() if state.mode == "refine":
            return unmarked(state)
        case _:
            sketch = _edited(state.sketch, event)
            if sketch is state.sketch:
                return state
            if len(sketch):
                return replace(state, sketch=sketch)
            return replace(state, sketch=sketch, followup=None, residual=None)


def _switched(state: State, mode: str, modeller: Modeller) -> State:
    return followup.entered(state, modeller) if mode == "followup" else replace(followup.left(state), mode=mode)


def _refining(state: State, modeller: Modeller) -> State:
    return state if state.mode == "refine" else _switched(state, "refine", modeller)


def _is_untouched(state: State, started: State) -> bool:
    """Whether a state is what starting from the template gives."""
    lines = state.followup is not None and state.followup.profile is None and state.followup.lines
    same = state.mode == started.mode and state.sketch == lines == started.sketch
    return same and state.residual is None


def _edited(sketch: Sketch, event: Event) -> Sketch:
    match event:
        case Draw(view="left" | "right" as view):
            raise ValueError(f"the profile is drawn in the follow-up mode; the view {view!r} was given in another")
        case Draw(points=points, mirror=mirror):
            drawn = sketch.with_segment(UNNAMED, points)
            image = np.stack([1 - points[:, 0], points[:, 1]], axis=1)
            return drawn.with_segment(UNNAMED, image) if mirror else drawn
        case Erase(points=points, radius=radius):
            return erase(sketch, points, radius)
        case Clear():
            return Sketch() if len(sketch) else sketch
        case _:
            raise TypeError(f"an edit is a Draw, Erase, Clear, Mode, TakeOver or the like; given {event!r}")
