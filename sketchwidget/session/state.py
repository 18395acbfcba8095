"""What a session is at one moment."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from sketchwidget.sketch import Sketch

from .refinement import UNREFINED, Refinement

if TYPE_CHECKING:
    from .followup import Followup
    from .take_over import Exaggeration, Residual


@dataclass(frozen=True)
class State:
    """One moment of a session; compared by value.

    Parameters
    ----------
    mode : str
        "initial", freehand drawing on a blank canvas; "followup", editing the lines of a head; or "refine", gestures on
        the head (the paper's sections 3.1 to 3.3).
    sketch : Sketch
        Strokes as drawn are "unnamed": which lines they are is inferred from it, and no part of the state. The lines of
        follow-up sketching have their names.
    followup : Followup, optional
        What is edited in follow-up sketching; it stays when the mode is left.
    refinement : Refinement
        What is marked on the head, and what gestures made of it.
    residual : Residual, optional
        What a head from elsewhere adds to the one that is inferred.
    exaggeration : Exaggeration, optional
        How much the head was exaggerated, while nothing was done since.
    """

    mode: str = "initial"
    sketch: Sketch = field(default_factory=Sketch)
    followup: Followup | None = None
    refinement: Refinement = UNREFINED
    residual: Residual | None = None
    exaggeration: Exaggeration | None = None
