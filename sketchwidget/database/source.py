"""What a source of faces offers; sources are plug-ins."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ..face.template import Template


class FaceSource(Protocol):
    """A generator or a collection of registered heads with one topology."""

    name: str
    template: Template

    def identity(self, number: int) -> np.ndarray:
        """Coarse vertices (n, 3) of identity `number` at rest; the same number gives the same face."""
        ...

    def expressions(self) -> dict[str, np.ndarray]:
        """Named poses (n, 3) of the source's own resting head, the resting head itself as "neutral" first."""
        ...
