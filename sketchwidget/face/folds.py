"""Where the skin of a head folds over itself, as seen from the front."""

from __future__ import annotations

import numpy as np

from .template import PARTS, Template

_FACING = 0.5  # cosine to the view: triangles that are seen more edge-on may turn


class FoldCounter:
    """Counts what is turned over of the skin that faces the front on a head at rest.

    Parameters
    ----------
    template : Template
    rest : (V, 3) array
    """

    def __init__(self, template: Template, rest: np.ndarray) -> None:
        skin = template.faces[(template.fine_parts[template.faces] == PARTS.index("skin")).all(axis=1)]
        edges = np.diff(np.asarray(rest, dtype=np.float64)[skin], axis=1)
        normals = np.cross(edges[:, 0], edges[:, 1])
        self._facing = skin[normals[:, 2] > _FACING * np.linalg.norm(normals, axis=1)]

    def __call__(self, vertices: np.ndarray) -> int:
        """How many triangles of a head (V, 3) face the back."""
        (x, y), (u, v) = np.moveaxis(np.diff(np.asarray(vertices)[self._facing, :2], axis=1), (1, 2), (0, 1))
        return int((x * v - y * u < 0).sum())
