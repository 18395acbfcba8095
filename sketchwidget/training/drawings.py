"""Drawings that people made of known heads, as pairs for training and measuring networks."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..database.drawings import Drawing
from ..face import FaceModel
from ..inference.normalise import normalise


def drawn_examples(drawings: Iterable[Drawing], model: FaceModel) -> tuple[np.ndarray, np.ndarray, int]:
    """Images of drawings as networks see them, and what they are drawings of.

    Parameters
    ----------
    drawings : iterable of Drawing
        Those of the side view are left out: the networks see the front.
    model : FaceModel
        Whose weights the drawings were kept with.

    Returns
    -------
    images : (n, 256, 256) bool array
        As for the regressor, with the ears and without what lies outside the head.
    codes : (n, k) float32 array
        Coordinates of the heads in the vertex basis of the model: core x_2 u x_3 v (equation 1).
    left_out : int
        Number of drawings of the side view.

    Raises
    ------
    ValueError
        If a drawing was kept with the weights of another model.
    """
    drawings, own, core = list(drawings), model.fingerprint, model.bilinear.core
    images, codes = [], []
    for number, drawing in enumerate(drawings):
        if drawing.model != own:
            raise ValueError(f"drawing {number} was kept with the weights of another face model: load that one")
        if drawing.view == "front":
            seen = normalise([segment.points for segment in drawing.sketch.segments])
            images.append(seen.face | seen.ears)
            codes.append(core @ drawing.expression @ drawing.identity)
    return (
        np.array(images, dtype=bool).reshape(-1, 256, 256),
        np.array(codes, dtype=np.float32).reshape(-1, core.shape[0]),
        len(drawings) - len(images),
    )
