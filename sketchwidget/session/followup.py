"""Follow-up sketching: the lines of a head, drawn to be edited (paper 3.2)."""

from __future__ import annotations

from dataclasses import replace

from sketchwidget.sketch import WRINKLE, Sketch

from .modeller import Modeller
from .state import State


def entered(state: State, modeller: Modeller) -> State:
    """The state with the projected lines of its head in place of silhouette and features; drawn wrinkles stay."""
    shown = modeller.head(state)
    lines = shown.face.sketch(wrinkles=False, view=shown.frame)
    named = state.sketch.renamed(shown.names)
    wrinkles = tuple(segment for segment in named.segments if segment.name == WRINKLE)
    return replace(state, mode="followup", sketch=Sketch((*lines.segments, *wrinkles)))


def from_template(modeller: Modeller) -> State:
    """The state that begins with the lines of the template."""
    return State("followup", modeller.model.face().sketch(wrinkles=False))
