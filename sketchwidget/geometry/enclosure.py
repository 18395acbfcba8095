"""What of the visible surface of a mesh lies within a closed line on the screen, or under a brush."""

from __future__ import annotations

import igl
import numpy as np
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree
from skimage.measure import points_in_poly

from .view import View
from .visibility import visible_vertices


def brushed(
    path: np.ndarray, radius: float, vertices: np.ndarray, faces: np.ndarray, view: View, among: np.ndarray
) -> np.ndarray:
    """Vertices of the visible surface under a brush.

    Parameters
    ----------
    path : (p, 2) array
        Where its middle went, canvas points.
    radius : float
        In canvas units.
    vertices : (n, 3) array
        Millimetres.
    faces : (m, 3) int array
        All that may hide the surface.
    view : View
    among : (n,) bool array
        The vertices that are asked for.

    Returns
    -------
    (k,) int array
    """
    path = np.asarray(path, dtype=np.float64)
    steps = np.ceil(np.linalg.norm(np.diff(path, axis=0), axis=1) / (radius / 4)).astype(int).clip(1, 1000)
    along = np.concatenate([np.arange(count) / count + place for place, count in enumerate(steps)] + [[len(path) - 1]])
    places = [np.interp(along, np.arange(len(path)), path[:, axis]) for axis in range(2)]
    away, _ = KDTree(np.stack(places, axis=1)).query(view.project(vertices), distance_upper_bound=radius)
    near = np.flatnonzero(np.asarray(among) & np.isfinite(away))
    return near[visible_vertices(vertices, faces, view.rotation, near)]


def enclosed(polygon: np.ndarray, vertices: np.ndarray, faces: np.ndarray, view: View, among: np.ndarray) -> np.ndarray:
    """Vertices of the visible surface within a closed line, and those that they hide in pockets.

    A pocket is what cannot be reached along the surface from the largest part that is left, as the inside of a mouth
    whose lips are within the line. Left out, it would hold the lips where they are.

    Parameters
    ----------
    polygon : (p, 2) array
        Canvas points; its last is joined to its first.
    vertices : (n, 3) array
        Millimetres.
    faces : (m, 3) int array
        All that may hide the surface.
    view : View
    among : (n,) bool array
        The vertices that are asked for.

    Returns
    -------
    (n,) bool array
    """
    within = np.asarray(among, dtype=bool) & points_in_poly(
        view.project(vertices), np.asarray(polygon, dtype=np.float64)
    )
    found = np.zeros(len(vertices), dtype=bool)
    places = np.flatnonzero(within)
    found[places] = visible_vertices(vertices, faces, view.rotation, places)
    if not found.any():
        return found
    rest = np.flatnonzero(among & ~found)
    neighbours = igl.adjacency_matrix(np.asarray(faces, dtype=np.int64)).tocsr()[rest][:, rest]
    _, part = connected_components(neighbours, directed=False)
    outside = np.bincount(part, minlength=1).argmax()
    pockets = rest[part != outside]
    found[pockets[within[pockets]]] = True
    return found
