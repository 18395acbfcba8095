"""Catmull-Clark subdivision as a matrix, so that a mesh is stored coarse and refined by one sparse product."""

from __future__ import annotations

import numpy as np
from scipy import sparse


def catmull_clark(quads: np.ndarray, vertex_count: int) -> tuple[sparse.csr_matrix, np.ndarray, np.ndarray]:
    """One Catmull-Clark step of a quad mesh.

    Parameters
    ----------
    quads : (m, 4) int array
        Vertex indices of a manifold quad mesh, with or without boundary.
    vertex_count : int
        Number of vertices n; each must be in some quad.

    Returns
    -------
    matrix : (n + e + m, n) sparse array
        Fine vertices from coarse ones: first the n moved vertices, then the e edge points, then the m face points.
    fine_quads : (4 m, 4) int32 array
    edges : (e, 2) int array
        Sorted vertex pairs, in the order of their edge points.

    Raises
    ------
    ValueError
        If the faces are not quads, an index is out of range or a vertex is in no quad.

    References
    ----------
    Catmull and Clark, "Recursively generated B-spline surfaces on arbitrary topological meshes", 1978; boundaries
    follow the cubic B-spline rule.
    """
    quads = np.asarray(quads)
    if quads.ndim != 2 or quads.shape[1] != 4:
        raise ValueError(f"Catmull-Clark here takes quads (m, 4); given an array of shape {quads.shape}")
    if not np.array_equal(np.unique(quads), np.arange(vertex_count)):
        raise ValueError(f"every one of the {vertex_count} vertices must be in some quad, and no other index")
    n, m = vertex_count, len(quads)
    half_edges = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges, edge_of, faces_at_edge = np.unique(
        np.sort(half_edges, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    e = len(edges)
    edge_of = edge_of.reshape(m, 4)

    face_points = _rows(np.repeat(np.arange(m), 4), quads.ravel(), 0.25, (m, n))
    midpoints = _rows(np.repeat(np.arange(e), 2), edges.ravel(), 0.5, (e, n))
    faces_beside = _rows(edge_of.ravel(), np.repeat(np.arange(m), 4), 1.0, (e, m))
    interior = faces_at_edge == 2
    edge_points = (
        sparse.diags(np.where(interior, 0.5, 1.0)) @ midpoints
        + sparse.diags(np.where(interior, 0.25, 0.0)) @ faces_beside @ face_points
    )

    edges_at = _rows(edges.ravel(), np.repeat(np.arange(e), 2), 1.0, (n, e))
    faces_at = _rows(quads.ravel(), np.repeat(np.arange(m), 4), 1.0, (n, m))
    valence = np.asarray(edges_at.sum(axis=1)).ravel()
    on_boundary = edges_at @ (~interior) > 0
    inner = (
        sparse.diags(1 / valence**2) @ faces_at @ face_points
        + sparse.diags(2 / valence**2) @ edges_at @ midpoints
        + sparse.diags(1 - 3 / valence)
    )
    border = 0.5 * sparse.eye(n) + 0.25 * edges_at @ sparse.diags((~interior).astype(float)) @ midpoints
    vertex_points = (
        sparse.diags((~on_boundary).astype(float)) @ inner + sparse.diags(on_boundary.astype(float)) @ border
    )

    centre = n + e + np.arange(m)
    fine = np.stack(
        [np.stack([quads[:, k], n + edge_of[:, k], centre, n + edge_of[:, k - 1]], axis=1) for k in range(4)],
        axis=1,
    ).reshape(-1, 4)
    matrix = sparse.csr_matrix(sparse.vstack([vertex_points, edge_points, face_points]), dtype=np.float32)
    return matrix, fine.astype(np.int32), edges


def _rows(rows: np.ndarray, columns: np.ndarray, value: float, shape: tuple[int, int]) -> sparse.csr_matrix:
    return sparse.csr_matrix((np.full(len(rows), value), (rows, columns)), shape=shape)
