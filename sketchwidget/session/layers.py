"""The layers of a head: each is stored apart, so that what lies above stays when one below changes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

from sketchwidget.geometry.alignment import similarity

if TYPE_CHECKING:
    from sketchwidget.face import Face


class Layer(Protocol):
    """What changes the head below it."""

    def on(self, head: Face) -> Face:
        """The head with this layer on it."""
        ...


@dataclass(frozen=True, eq=False)
class Displacement:
    """A layer of displacements that turn with the head below as a whole.

    Frames at the vertices would turn by anything where lids and lips that fold over move a little, and the large
    displacements of an exaggerated head with them: they would tear its skin.

    Parameters
    ----------
    offsets : (V, 3) array
        Millimetres, of a head that stands as the mean face does.
    """

    offsets: np.ndarray

    @classmethod
    def between(cls, below: Face, above: Face) -> Displacement:
        """The layer that makes one head of another."""
        return cls.of(below, above.vertices - below.vertices)

    @classmethod
    def of(cls, below: Face, displacement: np.ndarray) -> Displacement:
        """The layer that moves the vertices of a head by (V, 3) millimetres."""
        return cls((displacement @ _turn(below)).astype(np.float32))

    def __add__(self, other: Displacement) -> Displacement:
        return Displacement(self.offsets + other.offsets)

    def on(self, head: Face) -> Face:
        """The head with its vertices displaced."""
        from sketchwidget.face import Face

        return Face(head.model, head.vertices + (self.offsets @ _turn(head).T).astype(np.float32))


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
    def drawn(self) -> Face:
        """The head whose lines are drawn: all layers but the refinement."""
        head = self.parameters
        for layer in (self.residual, self.targets):
            head = head if layer is None else layer.on(head)
        return head

    def refined(self, refinement: Layer | None) -> Layers:
        """The same with another refinement; the layers below are not applied again."""
        layers = replace(self, refinement=refinement)
        layers.__dict__["drawn"] = self.drawn
        return layers

    @cached_property
    def head(self) -> Face:
        """All layers on top of each other."""
        return self.drawn if self.refinement is None else self.refinement.on(self.drawn)


def _turn(head: Face) -> np.ndarray:
    """The rotation (3, 3) by which a head is turned from the mean face."""
    return similarity(head.model.mean, head.vertices)[1]
