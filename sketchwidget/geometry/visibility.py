"""What of a mesh lies in front of points, and which points nothing hides."""

from __future__ import annotations

import igl
import numpy as np

_EDGE = (
    1e-6  # of a triangle: rounding opens no slit between two, as behind the vertices of a symmetric head from the side
)


def covering(points: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles that face a viewer far along z, over points or under them.

    Parameters
    ----------
    points : (p, 3) array
    vertices : (n, 3) array
    faces : (m, 3) int array

    Returns
    -------
    point : (k,) int array
        Index of a point, once for each triangle that has it within its outline.
    above : (k,) array
        How far that triangle lies in front of it along z; behind it, less than 0.
    """
    points, vertices = np.asarray(points, dtype=np.float64), np.asarray(vertices, dtype=np.float64)
    if not len(points):
        return np.empty(0, dtype=np.int64), np.empty(0)
    low, high = points.min(axis=0), points.max(axis=0)
    x, y, _ = vertices.T
    aside = np.stack([x < low[0], x > high[0], y < low[1], y > high[1]])
    a, b, c = np.asarray(faces).T
    near = np.flatnonzero(~(aside[:, a] & aside[:, b] & aside[:, c]).any(axis=0))
    corner, first, second = (
        vertices[a[near]],
        vertices[b[near]] - vertices[a[near]],
        vertices[c[near]] - vertices[a[near]],
    )
    double_area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    facing = double_area > 1e-9
    corner, first, second, double_area = corner[facing], first[facing], second[facing], double_area[facing]
    # Candidates: points within the triangle's box, found by their order from left to right.
    order = np.argsort(points[:, 0])
    left, right = (corner + pick(0.0, pick(first, second)) for pick in (np.minimum, np.maximum))
    start = np.searchsorted(points[order, 0], left[:, 0], side="left")
    count = np.searchsorted(points[order, 0], right[:, 0], side="right") - start
    triangle = np.repeat(np.arange(len(count)), count)
    point = order[np.arange(len(triangle)) + np.repeat(start - np.cumsum(count) + count, count)]
    height = points[point, 1]
    level = (left[triangle, 1] <= height) & (height <= right[triangle, 1])
    triangle, point = triangle[level], point[level]
    offset = points[point] - corner[triangle]
    first, second, double_area = first[triangle], second[triangle], double_area[triangle]
    s = (offset[:, 0] * second[:, 1] - offset[:, 1] * second[:, 0]) / double_area
    t = (first[:, 0] * offset[:, 1] - first[:, 1] * offset[:, 0]) / double_area
    inside = (s >= -_EDGE) & (t >= -_EDGE) & (s + t <= 1 + _EDGE)
    above = s * first[:, 2] + t * second[:, 2] - offset[:, 2]
    return point[inside], above[inside]


def visible_vertices(vertices: np.ndarray, faces: np.ndarray, rotation: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """Which vertices of a mesh a distant viewer sees: those that nothing hides, on a surface that faces the viewer.

    Parameters
    ----------
    vertices : (n, 3) array
        Millimetres.
    faces : (m, 3) int array
    rotation : (3, 3) array
        From the mesh's frame to the viewer's.
    asked : (k,) int array
        The vertices that are asked for.

    Returns
    -------
    (k,) bool array
    """
    triangles = np.asarray(faces, dtype=np.int64)
    normals = np.asarray(igl.per_vertex_normals(np.asarray(vertices, dtype=np.float64), triangles))
    seen = normals[asked] @ rotation[2] > 0
    seen[seen] = visible(np.asarray(vertices)[asked[seen]], vertices, faces, rotation)
    return seen


def visible(
    points: np.ndarray, vertices: np.ndarray, faces: np.ndarray, rotation: np.ndarray, tolerance: float = 1.0
) -> np.ndarray:
    """Which points of a closed mesh nothing hides from a distant viewer.

    Parameters
    ----------
    points : (p, 3) array
        On the mesh, millimetres.
    vertices : (n, 3) array
        Millimetres.
    faces : (m, 3) int array
    rotation : (3, 3) array
        From the mesh's frame to the viewer's: x right, y up, z to the viewer.
    tolerance : float
        What covers a point by less, in millimetres, does not hide it.

    Returns
    -------
    (p,) bool array
    """
    points, vertices = np.asarray(points, dtype=np.float64), np.asarray(vertices, dtype=np.float64)
    point, above = covering(points @ rotation.T, vertices @ rotation.T, faces)
    clear = np.ones(len(points), dtype=bool)
    clear[point[above > tolerance]] = False
    return clear
