"""How regular a triangle mesh is: edges at which it folds over, and normals that tell what is turned over."""

from __future__ import annotations

import igl
import numpy as np


def folded(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Which inner edges of a mesh join triangles whose normals are more than a right angle apart.

    Parameters
    ----------
    vertices : (n, 3) array
    faces : (m, 3) int array
        An oriented manifold.

    Returns
    -------
    (e,) bool array
        One for each edge between two triangles; an edge has the same place for every mesh with these faces.
    """
    sides, _ = igl.triangle_triangle_adjacency(np.asarray(faces, dtype=np.int64))[:2]
    first, side = np.nonzero(sides > np.arange(len(faces))[:, None])
    second = sides[first, side]
    normal = normals(vertices, faces)
    return (normal[:, first] * normal[:, second]).sum(axis=0) < 0


def normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """The normals (3, m) of the triangles of a mesh, as long as twice their areas."""
    corners = np.asarray(vertices, dtype=np.float64).T.take(np.asarray(faces).T, axis=1)
    (x, y, z), (u, v, w) = (corners[:, k] - corners[:, 0] for k in (1, 2))
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u])
