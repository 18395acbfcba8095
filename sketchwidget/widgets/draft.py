"""A drawing while it is made: strokes with pressure and time, of which every edit can be undone."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..database.drawings import as_sketch
from ..sketch import Sketch
from ..sketch.erase import erase_stroke
from ..sketch.pen import as_pen_stroke, from_tablet
from .steps import Steps

Strokes = tuple[np.ndarray, ...]


class Draft(Steps[Strokes]):
    """Strokes (n, 4) of x, y, pressure and milliseconds since the stroke began.

    Erasing leaves of a stroke what `sketch.erase` does. What is left keeps the pressure and the time that it was drawn
    with, so that the times of a fragment begin where it was cut off; at the cuts both are interpolated.
    """

    def __init__(self) -> None:
        super().__init__(())

    @property
    def strokes(self) -> Strokes:
        """The strokes that are there now, in the order they were drawn."""
        return self.present

    @property
    def sketch(self) -> Sketch:
        """The strokes without pressure and time."""
        return as_sketch(self.strokes)

    def draw(self, points: Any) -> None:
        """Draw a stroke (n, 4), as `Ink.on_stroke` gives it.

        Raises
        ------
        ValueError
            If it is no stroke, as `as_pen_stroke` has them.
        """
        self.go_to((*self.strokes, from_tablet(points)))

    def erase(self, path: Any, radius: float) -> bool:
        """Erase the ink under an eraser that went along a path (n, 2); False if there was none.

        Raises
        ------
        ValueError
            As `sketch.erase` does.
        """
        left = [_without(stroke, path, radius) for stroke in self.strokes]
        strokes = tuple(part for parts in left for part in parts)
        changed = [*map(id, strokes)] != [*map(id, self.strokes)]
        if changed:
            self.go_to(strokes)
        return changed

    def clear(self) -> bool:
        """Remove all ink; False if there was none."""
        if self.strokes:
            self.go_to(())
            return True
        return False


def _without(stroke: np.ndarray, path: Any, radius: float) -> list[np.ndarray]:
    """What an eraser leaves of a stroke: the same object if it is not under it."""
    fragments = erase_stroke(stroke, path, radius)
    if fragments is None:
        return [stroke]
    for fragment in fragments:
        fragment[:, 3] = np.maximum.accumulate(fragment[:, 3])  # interpolation rounds
    return [as_pen_stroke(fragment) for fragment in fragments]
