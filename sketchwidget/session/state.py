"""What a session is at one moment."""

from __future__ import annotations

from dataclasses import dataclass, field

from sketchwidget.sketch import Sketch


@dataclass(frozen=True)
class State:
    """One moment of a session; compared by value.

    Parameters
    ----------
    mode : str
        "initial": freehand drawing on a blank canvas (the paper's section 3.1).
    sketch : Sketch
        The strokes as drawn, "unnamed": which lines they are is inferred from it, and no part of the state.
    """

    mode: str = "initial"
    sketch: Sketch = field(default_factory=Sketch)
