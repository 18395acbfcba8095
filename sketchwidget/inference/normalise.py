"""A drawing as the networks see it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..sketch import rasterise
from .framing import Frame
from .naming import whereabouts
from .outline import Outline, find_outline


@dataclass(frozen=True)
class Normalised:
    """A drawing at its normal place and size; hair, a neck and whatever else lies outside the head are left out.

    Parameters
    ----------
    outline : Outline or None
        Of the head, on the canvas.
    strokes : list of (n, 2) arrays
        At their normal place and size.
    places : list of str
        Whereabouts of each stroke; all "inside" where there is no outline.
    face : (256, 256) bool array
        The ink inside the outline and the outline itself.
    """

    outline: Outline | None
    strokes: list[np.ndarray]
    places: list[str]
    face: np.ndarray


def normalise(strokes: Sequence[np.ndarray]) -> Normalised:
    """Place and size of a drawing are taken from its outline; while there is none, the canvas is the frame.

    Parameters
    ----------
    strokes : sequence of (n, 2) arrays
        Canvas points.
    """
    outline = find_outline(strokes)
    if outline is None:
        frame, places = Frame(), ["inside"] * len(strokes)
    else:
        frame, places = Frame.of_outline(outline.points), whereabouts(strokes, outline)
    framed = [frame(stroke) for stroke in strokes]
    face = rasterise([stroke for stroke, place in zip(framed, places, strict=True) if place == "inside"])
    return Normalised(outline, framed, places, face)
