"""Triangles to pixels: which triangle is seen where, and at which of its points."""

from __future__ import annotations

import numpy as np


def rasterise(
    corners: np.ndarray, faces: np.ndarray, shape: tuple[int, int], depth: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Draw the triangles of a mesh into a picture of their numbers.

    Parameters
    ----------
    corners : (n, 2) array
        Pixels, x to the right and y down; the middle of the first pixel is (0.5, 0.5).
    faces : (m, 3) int array
        Either way round.
    shape : (int, int)
        Height and width of the picture.
    depth : (n,) array, optional
        Of several triangles at one pixel the greatest is seen; without it, the last.

    Returns
    -------
    triangle : (H, W) int array
        Index of the triangle that is seen, -1 where there is none.
    weights : (H, W, 3) float32 array
        Barycentric coordinates of the pixel's middle in that triangle.
    """
    height, width = shape
    a, b, c = (np.asarray(corners, dtype=np.float64)[faces[:, k]] for k in range(3))
    double_area = _cross(b - a, c - a)
    low = np.ceil(np.minimum(np.minimum(a, b), c) - 0.5).astype(np.int64)
    high = np.floor(np.maximum(np.maximum(a, b), c) - 0.5).astype(np.int64)
    low, high = np.maximum(low, 0), np.minimum(high, (width - 1, height - 1))
    size = np.maximum(high - low + 1, 0) * (np.abs(double_area) > 1e-12)[:, None]

    # Candidates: each triangle's bounding box, row by row.
    rows = np.repeat(np.arange(len(faces)), size[:, 1] * (size[:, 0] > 0))
    row = low[rows, 1] + _counted(size[:, 1] * (size[:, 0] > 0))
    triangle = np.repeat(rows, size[rows, 0])
    y = np.repeat(row, size[rows, 0])
    x = low[triangle, 0] + _counted(size[rows, 0])
    offset = np.stack([x + 0.5, y + 0.5], axis=1) - a[triangle]
    second = _cross(offset, (c - a)[triangle]) / double_area[triangle]
    third = _cross((b - a)[triangle], offset) / double_area[triangle]
    inside = (second >= 0) & (third >= 0) & (second + third <= 1)
    triangle, x, y = triangle[inside], x[inside], y[inside]
    weights = np.stack([1 - second - third, second, third], axis=1)[inside]
    if depth is not None:
        order = np.argsort((np.asarray(depth)[faces[triangle]] * weights).sum(axis=1), kind="stable")
        triangle, x, y, weights = triangle[order], x[order], y[order], weights[order]

    seen = np.full(shape, -1, dtype=np.int64)
    share = np.zeros((*shape, 3), dtype=np.float32)
    seen[y, x] = np.arange(len(triangle))  # the last of several stays
    drawn = seen >= 0
    share[drawn] = weights[seen[drawn]]
    seen[drawn] = triangle[seen[drawn]]
    return seen, share


def _cross(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]


def _counted(counts: np.ndarray) -> np.ndarray:
    """0 to count - 1 for each count, one after the other."""
    return np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
