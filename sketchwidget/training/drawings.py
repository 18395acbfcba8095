"""Drawings that people made of known heads, as examples for training and measuring networks."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..database.drawings import Drawing
from ..face.model import FaceModel
from ..inference.normalise import normalise
from ..inference.shape_code import POINTS
from ..sketch import Sketch
from ..sketch.augment import deform_lines
from .manners import Drawn
from .standard import standardised_pose


class DrawnExamples:
    """Examples from drawings by people, each bent a little differently every time that it is taken.

    Parameters
    ----------
    drawings : iterable of Drawing
        Those of the side view are left out: networks see the front.
    model : FaceModel
        Whose weights the drawings were kept with.

    Raises
    ------
    ValueError
        If a drawing was kept with the weights of another model, or there is none of the front.
    """

    def __init__(self, drawings: Iterable[Drawing], model: FaceModel) -> None:
        self._sketches: list[Sketch] = []
        codes, poses, own = [], [], model.fingerprint
        for number, drawing in enumerate(drawings):
            if drawing.model != own:
                raise ValueError(f"drawing {number} was kept with the weights of another face model: load that one")
            if drawing.view == "front":
                self._sketches.append(drawing.sketch)
                codes.append(model.bilinear.core @ drawing.expression @ drawing.identity)
                poses.append(standardised_pose(model, drawing.expression))
        if not codes:
            raise ValueError("none of the drawings shows the front")
        self._codes, self._poses = (np.array(values, dtype=np.float32) for values in (codes, poses))

    def __len__(self) -> int:
        return len(self._sketches)

    def example(self, random: np.random.Generator) -> tuple[Drawn, np.ndarray, np.ndarray]:
        """One drawing, bent, and the code (k,) and standardised expression weights (q,) of its head."""
        number = int(random.integers(len(self)))
        seen = normalise([segment.points for segment in deform_lines(self._sketches[number], random).segments])
        nothing = np.zeros(POINTS, dtype=bool)  # whose lines they are, nobody said
        drawn = Drawn(seen.face, np.zeros((len(nothing), 2)), nothing)
        return drawn, self._codes[number], self._poses[number]
