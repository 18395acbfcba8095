"""The layers of a head: each is stored apart, so that what lies above stays when one below changes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sketchwidget.face import Face


@dataclass(frozen=True)
class Layers:
    """What a head is made of, the lowest layer first.

    Parameters
    ----------
    parameters : Face
        The head of the identity and expression weights that were inferred.
    """

    parameters: Face

    @property
    def head(self) -> Face:
        """All layers on top of each other."""
        return self.parameters
