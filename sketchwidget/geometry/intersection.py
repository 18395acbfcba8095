"""Which triangles of one patch of a mesh cut those of another, and which of a mesh cut each other."""

from __future__ import annotations

import numpy as np

_SLICE = 256  # triangles compared with their neighbours at once


def intersecting(vertices: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Pairs of triangles that cut each other: where an edge of one passes through the other.

    Triangles that share a vertex are left out, and so are those that lie in one plane.

    Parameters
    ----------
    vertices : (n, 3) array
    first, second : (a, 3) and (b, 3) int arrays
        Triangles of the two patches.

    Returns
    -------
    (k, 2) int array
        Index in `first` and in `second` of each pair.
    """
    points = np.asarray(vertices, dtype=np.float64)
    in_a, (low_a, high_a) = _in_box(points, first, points[second])
    in_b, (low_b, high_b) = _in_box(points, second, points[first[in_a]])
    near = np.ones((len(in_a), len(in_b)), dtype=bool)
    for axis in range(3):
        near &= low_a[in_a, None, axis] <= high_b[in_b, axis]
        near &= high_a[in_a, None, axis] >= low_b[in_b, axis]
    a, b = np.nonzero(near)
    a, b = in_a[a], in_b[b]
    apart = ~(first[a][:, :, None] == second[b][:, None, :]).any(axis=(1, 2))
    a, b = a[apart], b[apart]
    corners_a, corners_b = points[first[a]], points[second[b]]
    cut = _edges_pass(corners_a, corners_b) | _edges_pass(corners_b, corners_a)
    return np.stack([a[cut], b[cut]], axis=1)


def self_intersecting(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Pairs of triangles of one mesh that cut each other, as `intersecting` has it.

    Parameters
    ----------
    vertices : (n, 3) array
    faces : (m, 3) int array

    Returns
    -------
    (k, 2) int array
        Indices of triangles, the lower one first.
    """
    points = np.asarray(vertices, dtype=np.float64)
    lowest, highest = (extreme(points[faces][:, :, 0], axis=1) for extreme in (np.min, np.max))
    order = np.argsort(lowest)
    pairs = []
    for start in range(0, len(order), _SLICE):  # from left to right, each slice against what begins within it
        block = order[start : start + _SLICE]
        end = np.searchsorted(lowest[order], highest[block].max(), side="right")
        others = order[start:end]
        found = intersecting(points, faces[block], faces[others])
        pairs.append(np.stack([block[found[:, 0]], others[found[:, 1]]], axis=1))
    return np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0) if pairs else np.empty((0, 2), dtype=int)


def _in_box(
    points: np.ndarray, triangles: np.ndarray, others: np.ndarray
) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """Which triangles (m, 3) meet the box about all others (k, 3, 3), and the least and greatest corners of each."""
    low, high = points[triangles].min(axis=1), points[triangles].max(axis=1)
    if not len(others):
        return np.empty(0, dtype=int), (low, high)
    meets = (low <= others.max(axis=(0, 1))) & (high >= others.min(axis=(0, 1)))
    return np.flatnonzero(meets.all(axis=1)), (low, high)


def _edges_pass(corners: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Whether an edge of each triangle (k, 3, 3) passes through its partner (k, 3, 3): Moeller and Trumbore 1997."""
    origin, one, two = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    passes = np.zeros(len(corners), dtype=bool)
    for start, end in ((0, 1), (1, 2), (2, 0)):
        along, offset = corners[:, end] - corners[:, start], corners[:, start] - origin
        p, q = np.cross(along, two), np.cross(offset, one)
        determinant = (one * p).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            u = (offset * p).sum(axis=1) / determinant
            v = (along * q).sum(axis=1) / determinant
            t = (two * q).sum(axis=1) / determinant
            passes |= (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0) & (t <= 1)
    return passes
