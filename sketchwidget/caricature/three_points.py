"""Landmarks to begin with, where nobody has found any: the mean face brought to three points of a picture."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..face.model import FaceModel
from ..geometry.finite import check_finite
from ..portrait.landmarks import OUTER_EYE_CORNERS

COUNT = 3
CHIN = 8  # of the 68 landmarks in iBUG order

_FLATTEST = 0.1  # of the distance of the eyes: with the chin nearer to their line, it is no face


def landmarks_from(points: Any, model: FaceModel) -> np.ndarray:
    """Where the landmarks are about, going by the outer corners of both eyes and the chin.

    The mean face, seen from the front, is stretched and sheared until its own lie there.

    Parameters
    ----------
    points : (3, 2) array-like
        Pixels, y down: the two outer corners in any order, then the chin.
    model : FaceModel

    Returns
    -------
    (68, 2) float64 array
        In iBUG order.

    Raises
    ------
    ValueError
        If they are not three finite points that span a face.
    """
    given = np.asarray(points, dtype=np.float64)
    check_finite(given, (COUNT, 2), "a face is begun by three finite points (3, 2) of pixels", "point")
    eyes, chin = given[given[:2, 0].argsort()], given[2]
    along, down = eyes[1] - eyes[0], chin - eyes.mean(axis=0)
    size = float(np.linalg.norm(along))
    depth = along[0] * down[1] - along[1] * down[0]  # positive: the chin is below the eyes
    if not depth > _FLATTEST * size**2 or size < 1.0:
        raise ValueError("the chin lies below the eyes, whose outer corners lie side by side: click these three anew")
    seen = model.mean[model.landmarks][:, :2].astype(np.float64) * [1, -1]
    corners = [*OUTER_EYE_CORNERS, CHIN]
    affine = np.linalg.solve(np.column_stack([seen[corners], np.ones(COUNT)]), np.vstack([eyes, chin]))
    return np.column_stack([seen, np.ones(len(seen))]) @ affine
