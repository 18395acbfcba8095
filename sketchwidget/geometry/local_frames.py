"""A frame at each vertex of a mesh, which turns with its surface."""

from __future__ import annotations

import igl
import numpy as np


def local_frames(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Orthonormal frames along the surface.

    Parameters
    ----------
    vertices : (n, 3) array
    faces : (m, 3) int array
        Each vertex belongs to a face.

    Returns
    -------
    (n, 3, 3) float32 array
        Columns: the tangent towards a neighbour, always the same one of a topology; the bitangent; the normal. A
        displacement in these coordinates goes with the surface when it is rotated or bent.

    Raises
    ------
    ValueError
        If a vertex belongs to no face.
    """
    vertices, faces = np.asarray(vertices, dtype=np.float64), np.asarray(faces, dtype=np.int64)
    neighbour = np.full(len(vertices), -1)
    for corner in range(3):
        neighbour[faces[:, corner]] = faces[:, (corner + 1) % 3]
    if (neighbour < 0).any():
        raise ValueError(f"local frames need each vertex in a face; {int((neighbour < 0).sum())} are in none")
    normal = np.asarray(igl.per_vertex_normals(vertices, faces))
    along = vertices[neighbour] - vertices
    tangent = _unit(along - (along * normal).sum(axis=1, keepdims=True) * normal)
    return np.stack([tangent, np.cross(normal, tangent), normal], axis=-1).astype(np.float32)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
