"""What a source of faces offers; sources are plug-ins."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import Protocol

import numpy as np

from ..face.template import Template
from .posing import Posing


class FaceSource(Protocol):
    """A generator or a collection of registered heads with one topology.

    Attributes
    ----------
    name : str
    template : Template
    expressions : tuple of str
        Names of the expressions, "neutral" among them.
    count : int or None
        Number of identities; None if there are as many as one asks for.
    """

    name: str
    template: Template
    count: int | None

    @property
    def expressions(self) -> tuple[str, ...]:
        """Names of the expressions, "neutral" among them."""
        ...

    def heads(self, number: int) -> np.ndarray:
        """Identity `number` in every expression: coarse vertices (expressions, n, 3) float32.

        The same number gives the same face. Heads of all identities are aligned with each other and in one unit.
        """
        ...

    def rest(self, number: int) -> np.ndarray:
        """Identity `number` at rest, as it is among its `heads`, without the work of posing the others: (n, 3)."""
        ...


class TransferredSource(ABC):
    """A source with one set of poses, of its own resting head; deformation transfer carries them to its identities."""

    template: Template
    count: int | None = None

    @abstractmethod
    def identity(self, number: int) -> np.ndarray:
        """Coarse vertices (n, 3) of identity `number` at rest, in any unit and place."""

    @abstractmethod
    def poses(self) -> dict[str, np.ndarray]:
        """Named poses (n, 3) of the source's own resting head, the resting head itself as "neutral" first."""

    @property
    def expressions(self) -> tuple[str, ...]:
        """Names of the expressions, "neutral" first."""
        return tuple(self._poses)

    def heads(self, number: int) -> np.ndarray:
        """Identity `number` in every expression: coarse vertices (expressions, n, 3) float32, millimetres, aligned."""
        return self._posing(self.identity(number))

    def rest(self, number: int) -> np.ndarray:
        """Identity `number` at rest: coarse vertices (n, 3), millimetres, aligned."""
        return self._posing.aligned(self.identity(number))

    @cached_property
    def _posing(self) -> Posing:
        return Posing(self.template, self._poses)

    @cached_property
    def _poses(self) -> dict[str, np.ndarray]:
        return self.poses()
