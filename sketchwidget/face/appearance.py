"""The colours of a head: clay skin, and enough of eyes and mouth to read an expression."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from .template import PARTS, Template

CLAY = (0.80, 0.68, 0.60)
_COLORS = {"skin": CLAY, "mouth": (0.42, 0.16, 0.15), "eyes": (0.94, 0.93, 0.91), "teeth": (0.93, 0.91, 0.85)}
_COLORS["tongue"] = (0.72, 0.34, 0.34)
_IRIS, _PUPIL = (0.30, 0.24, 0.20), (0.05, 0.05, 0.06)
_BROW, _BROW_MM = (0.46, 0.36, 0.30), (1.0, 4.5)  # hair along the brow's curve, and where it thins out
_BARE = 0.25  # of the curve, from the middle of the face
_IRIS_ANGLE, _PUPIL_ANGLE = 31.0, 15.0  # degrees from the eye's axis


def vertex_colors(template: Template, mean: np.ndarray) -> np.ndarray:
    """Colour (V, 3) float32 of each fine vertex, by part.

    Iris and pupil go by their angle about the mean eyes' axes, brows by the distance from their curves.
    """
    colors = np.array([_COLORS[part] for part in PARTS], dtype=np.float32)[template.fine_parts]
    eyes = template.fine_parts == PARTS.index("eyes")
    for side in (mean[:, 0] > 0, mean[:, 0] < 0):
        eye = np.flatnonzero(eyes & side)
        centre = (mean[eye].min(axis=0) + mean[eye].max(axis=0)) / 2
        direction = mean[eye] - centre
        angle = np.degrees(np.arctan2(np.hypot(direction[:, 0], direction[:, 1]), direction[:, 2]))
        colors[eye[angle < _IRIS_ANGLE]] = _IRIS
        colors[eye[angle < _PUPIL_ANGLE]] = _PUPIL
    skin = np.flatnonzero(template.fine_parts == PARTS.index("skin"))
    curves = [template.curves["left_brow"], template.curves["right_brow"]]
    brows = mean[np.concatenate([curve[int(_BARE * len(curve)) :] for curve in curves])]
    full, none = _BROW_MM
    bare = np.clip((KDTree(brows).query(mean[skin])[0] - full) / (none - full), 0.0, 1.0)[:, None]
    colors[skin] = bare * colors[skin] + (1 - bare) * np.array(_BROW, dtype=np.float32)
    return colors
