"""Heads that no drawing gave: how one from elsewhere, or one exaggerated, becomes the head of a session."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sketchwidget.face.drawing import editable
from sketchwidget.geometry.view import View

from .followup import Followup, left
from .layers import Displacement, Layer, Layers
from .packed import rounded
from .state import State

if TYPE_CHECKING:
    from sketchwidget.face import Face
    from sketchwidget.face.texture import Texture

    from .modeller import Modelled, Modeller

MARGIN = 0.03  # canvas units, left free about lines that would leave the pad

_SMALLEST = 20.0  # mm in each direction, a tenth of a face


@dataclass(frozen=True, eq=False)
class Residual:
    """What a head from elsewhere adds to the one that is inferred from its lines.

    Parameters
    ----------
    layer : Layer
    inferred, frame : View
        Where the head that was inferred stood when the layer was made, and where the one from elsewhere did.
    texture : Texture, optional
        What lies on it, whatever its shape becomes.
    """

    layer: Layer
    inferred: View
    frame: View
    texture: Texture | None = None

    def on(self, modelled: Modelled) -> Modelled:
        """An inferred head with it, where it stands now that the former moved to another frame."""
        view, ratio = modelled.frame, self.frame.scale / self.inferred.scale
        centre = self.frame.centre + ratio * (view.centre - self.inferred.centre)
        layers = replace(modelled.layers, residual=self.layer)
        return replace(modelled, layers=layers, frame=View(scale=ratio * view.scale, centre=centre))


@dataclass(frozen=True, eq=False)
class Exaggeration:
    """How much a head was exaggerated, and what it was before."""

    amount: float
    before: State


def taken_over(face: Face, modeller: Modeller, texture: Texture | None = None) -> State:
    """The state in which the lines of a head from elsewhere are edited, with the texture that lies on it.

    Its parameters are what is inferred from its lines, and what they lack is the residual: so it is the head as it was,
    and what is edited later changes the parameters below the residual.

    Raises
    ------
    ValueError
        If it has next to no extent.
    """
    from .modeller import Modelled

    if (extent := np.ptp(face.vertices, axis=0)).min() < _SMALLEST:
        raise ValueError(f"a head has at least {_SMALLEST:g} mm in each direction; given one of {extent.round(1)} mm")
    frame = standing(face)
    sketch = editable(face.model.template, face.vertices, frame)
    inferred = modeller.inferred(sketch)
    parameters = inferred.layers.parameters
    residual = Residual(Displacement.between(parameters, face), inferred.frame, frame, texture)
    layers = Layers.giving(face, parameters, residual.layer)
    start = Modelled(layers, frame, tuple(segment.name for segment in sketch.segments))
    return State("followup", sketch, Followup(start, sketch), residual=residual)


def exaggerated(state: State, amount: float, modeller: Modeller) -> State:
    """The state in which the head, with all its layers, is exaggerated; at 1 the one in which it was not.

    After another exaggeration, it is the head before that one that is exaggerated.
    """
    from sketchwidget.caricature.exaggeration import exaggerate

    former = state.exaggeration
    if amount == (1.0 if former is None else former.amount):
        return state
    before = state if former is None else former.before
    if amount == 1.0:
        return before
    whole = left(before)
    face = exaggerate(modeller.head(whole).face, amount)
    rounded(face.vertices)  # refuses what is larger than any head
    taken = taken_over(face, modeller, None if before.residual is None else before.residual.texture)
    return replace(
        taken,
        mode="refine" if before.mode == "refine" else taken.mode,
        refinement=replace(whole.refinement, layer=None),
        exaggeration=Exaggeration(amount, before),
    )


def standing(face: Face) -> View:
    """The front view in which all lines of a head are on the pad: the canonical one, or one further away."""
    view = View()
    points = np.concatenate([view.project(face.curve(name)) for name in face.model.curves])
    low, high = points.min(axis=0), points.max(axis=0)
    if low.min() >= 0 and high.max() <= 1:
        return view
    shrink = min(1.0, (1 - 2 * MARGIN) / float((high - low).max()))
    centre = 0.5 + shrink * (view.centre - (low + high) / 2)
    return View(scale=shrink * view.scale, centre=centre)
