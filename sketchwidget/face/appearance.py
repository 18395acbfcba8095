"""The colours of a head: clay skin, and enough of eyes and mouth to read an expression."""

from __future__ import annotations

import numpy as np

from .template import PARTS, Template

CLAY = (0.80, 0.68, 0.60)
_COLORS = {"skin": CLAY, "mouth": (0.42, 0.16, 0.15), "eyes": (0.94, 0.93, 0.91), "teeth": (0.93, 0.91, 0.85)}
_COLORS["tongue"] = (0.72, 0.34, 0.34)
_IRIS, _PUPIL = (0.30, 0.24, 0.20), (0.05, 0.05, 0.06)
_IRIS_ANGLE, _PUPIL_ANGLE = 31.0, 15.0  # degrees from the eye's axis


def vertex_colors(template: Template, mean: np.ndarray) -> np.ndarray:
    """Colour (V, 3) float32 of each fine vertex, by part; iris and pupil by their angle about the mean eyes' axes."""
    colors = np.array([_COLORS[part] for part in PARTS], dtype=np.float32)[template.fine_parts]
    eyes = template.fine_parts == PARTS.index("eyes")
    for side in (mean[:, 0] > 0, mean[:, 0] < 0):
        eye = np.flatnonzero(eyes & side)
        centre = (mean[eye].min(axis=0) + mean[eye].max(axis=0)) / 2
        direction = mean[eye] - centre
        angle = np.degrees(np.arctan2(np.hypot(direction[:, 0], direction[:, 1]), direction[:, 2]))
        colors[eye[angle < _IRIS_ANGLE]] = _IRIS
        colors[eye[angle < _PUPIL_ANGLE]] = _PUPIL
    return colors
