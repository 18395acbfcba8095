"""Edges of a triangle mesh, and distances along them."""

from __future__ import annotations

import igl
import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import dijkstra


def edges(faces: np.ndarray) -> np.ndarray:
    """The edges (e, 2) int64 of triangles (m, 3), each once."""
    faces = np.asarray(faces, dtype=np.int64)
    return np.asarray(igl.edges(faces)) if len(faces) else np.empty((0, 2), dtype=np.int64)


def edge_graph(vertices: np.ndarray, faces: np.ndarray) -> sparse.csr_matrix:
    """Lengths (n, n) of the edges between vertices (n, 3), each once: for `scipy.sparse.csgraph`, undirected."""
    between = edges(faces)
    length = np.linalg.norm(vertices[between[:, 0]] - vertices[between[:, 1]], axis=1)
    return sparse.csr_matrix((length, between.T), (len(vertices), len(vertices)))


def edge_distance(vertices: np.ndarray, faces: np.ndarray, sources: np.ndarray, limit: float = np.inf) -> np.ndarray:
    """How far (n,) the nearest of some vertices is along the edges; infinite beyond the limit, and where none is."""
    if not len(sources):
        return np.full(len(vertices), np.inf)
    return dijkstra(
        edge_graph(vertices, faces), directed=False, indices=np.asarray(sources), min_only=True, limit=limit
    )
