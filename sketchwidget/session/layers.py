"""The layers of a head: each is stored apart, so that what lies above stays when one below changes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from sketchwidget.face import Face


class Layer(Protocol):
    """What changes the head below it."""

    def on(self, head: Face) -> Face:
        """The head with this layer on it."""
        ...


@dataclass(frozen=True, eq=False)
class Displacement:
    """A layer of displacements, which stay as they are when the head below gets another face.

    All heads of a model stand alike, so that nothing need turn with them. Displacements in frames of the surface would:
    where lids and lips that fold over move a little, such frames turn by anything, and the large displacements of an
    exaggerated head would tear its skin.

    Parameters
    ----------
    offsets : (V, 3) array
        Millimetres.
    """

    offsets: np.ndarray

    @classmethod
    def between(cls, below: Face, above: Face) -> Displacement:
        """The layer that makes one head of another."""
        return cls(above.vertices - below.vertices)

    def __add__(self, other: Displacement) -> Displacement:
        return Displacement(self.offsets + other.offsets)

    def on(self, head: Face) -> Face:
        """The head with its vertices displaced."""
        from sketchwidget.face import Face

        return Face(head.model, head.vertices + self.offsets)


@dataclass(frozen=True, eq=False)
class Layers:
    """What a head is made of, the lowest layer first.

    Parameters
    ----------
    parameters : Face
        The head of the identity and expression weights that were inferred.
    residual : Layer, optional
        What a caricature or a portrait adds to it.
    targets : Layer, optional
        The lines edited in follow-up sketching, which its curve handles follow.
    refinement : Layer, optional
        What gestures changed.
    """

    parameters: Face
    residual: Layer | None = None
    targets: Layer | None = None
    refinement: Layer | None = None

    @classmethod
    def giving(cls, head: Face, parameters: Face, residual: Layer) -> Layers:
        """Parameters and residual of a head that is known: exactly that is drawn, the residual is not applied."""
        layers = cls(parameters, residual)
        layers.__dict__["drawn"] = head
        return layers

    @cached_property
    def below(self) -> Face:
        """The head below the edited lines."""
        return self.parameters if self.residual is None else self.residual.on(self.parameters)

    @cached_property
    def drawn(self) -> Face:
        """The head whose lines are drawn: all layers but the refinement."""
        return self.below if self.targets is None else self.targets.on(self.below)

    def refined(self, refinement: Layer | None) -> Layers:
        """The same with another refinement; the layers below are not applied again."""
        layers = replace(self, refinement=refinement)
        layers.__dict__["drawn"] = self.drawn
        return layers

    @cached_property
    def head(self) -> Face:
        """All layers on top of each other."""
        return self.drawn if self.refinement is None else self.refinement.on(self.drawn)
