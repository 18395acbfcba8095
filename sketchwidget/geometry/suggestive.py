"""Suggestive contours: where a surface nearly turns away from the viewer (DeCarlo et al. 2003)."""

from __future__ import annotations

import igl
import numpy as np
from scipy import sparse

_SMOOTHING = 3  # rounds of averaging over neighbours; the normals' differences are noisy on small triangles


class SuggestiveContours:
    """Finds the suggestive contours of all meshes of one topology, seen by a distant viewer.

    Parameters
    ----------
    faces : (m, 3) int array
        Triangles of a manifold mesh.
    region : (n,) bool array
        Vertices about which lines are wanted; triangles far from them are never looked at.

    Raises
    ------
    ValueError
        If the region has no triangle.

    References
    ----------
    DeCarlo, Finkelstein, Rusinkiewicz and Santella, "Suggestive contours for conveying shape", 2003, definition I and
    section 3.1.
    """

    def __init__(self, faces: np.ndarray, region: np.ndarray) -> None:
        faces, region = np.asarray(faces, dtype=np.int64), np.asarray(region, dtype=bool)
        if not region[faces].all(axis=1).any():
            raise ValueError("suggestive contours are drawn in a region of at least one triangle; the region has none")
        near = region.copy()
        for _ in range(_SMOOTHING + 3):  # normals, curvature and derivative each look one ring further
            near[faces[near[faces].any(axis=1)]] = True
        self._kept = np.flatnonzero(near)
        number_of = np.full(len(region), -1)
        number_of[self._kept] = np.arange(len(self._kept))
        faces = number_of[faces]
        self._faces = faces[(faces >= 0).all(axis=1)]
        n, m = len(self._kept), len(self._faces)
        self._around = sparse.csr_matrix((np.ones(3 * m), (self._faces.ravel(), np.repeat(np.arange(m), 3))), (n, m))
        neighbours = igl.adjacency_matrix(self._faces).astype(np.float64)
        valence = np.asarray(neighbours.sum(axis=1)).ravel()
        self._average = 0.5 * (sparse.eye(n) + sparse.diags(1 / np.maximum(valence, 1)) @ neighbours).tocsr()

        inside = self._faces[region[self._kept][self._faces].all(axis=1)]
        sides = np.sort(np.stack([inside, np.roll(inside, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
        self._edges, edge_of = np.unique(sides, axis=0, return_inverse=True)
        self._edges_of_face = edge_of.reshape(-1, 3)

    def __call__(
        self, vertices: np.ndarray, direction: np.ndarray, angle: float, least: float, peak: float
    ) -> list[np.ndarray]:
        """The suggestive contours as polylines, those on the far side of the mesh too.

        Parameters
        ----------
        vertices : (n, 3) array
            Millimetres.
        direction : (3,) array
            Unit vector to the viewer.
        angle : float
            Degrees; surface that faces the viewer more than this has no lines (the paper's theta_c).
        least, peak : float
            1/mm^2; a line goes on while the derivative of its radial curvature is above the first (the paper's t_d),
            and counts if that is above the second somewhere.

        Returns
        -------
        list of (k, 3) arrays
            Points where the lines cross the edges of the mesh, in order; a closed line ends where it starts.
        """
        bend, slope, sine = self._bend(vertices, direction)
        crossed = np.flatnonzero((bend[self._edges] > 0).sum(axis=1) == 1)
        start, end = self._edges[crossed].T
        share = bend[start] / (bend[start] - bend[end])

        def between(values: np.ndarray) -> np.ndarray:
            part = share if values.ndim == 1 else share[:, None]
            return values[start] + part * (values[end] - values[start])

        sine = between(sine)
        strength = np.where(sine > np.sin(np.radians(angle)), between(slope) / np.maximum(sine, 1e-9) ** 2, 0.0)
        points = between(np.asarray(vertices, dtype=np.float64)[self._kept])
        number_of = np.full(len(self._edges), -1)
        number_of[crossed] = np.where(strength > least, np.arange(len(crossed)), -1)
        # A line enters a triangle through one edge and leaves it through another.
        met = np.sort(number_of[self._edges_of_face], axis=1)
        paths = _paths(met[met[:, 1] >= 0, 1:])
        return [points[path] for path in paths if strength[path].max() > peak]

    def _bend(self, vertices: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Radial curvature times `w w`, the derivative of that along the unit `w`, and the length of `w`; (k,) each.

        With `n` the normal, `v` the direction and `w = v - (n v) n`, the radial curvature is the derivative of `n v`
        along `w`, over `w w`: what bends the normal in the plane of `n` and `v`. A convex surface has it positive.

        The product is what is smoothed and followed to zero: it has the zeros of the curvature, and none of its noise
        where the surface faces the viewer.
        """
        v = np.asarray(vertices, dtype=np.float64)[self._kept]
        a, b, c = (v[self._faces[:, k]] for k in range(3))
        across = np.cross(b - a, c - a)
        double_area = np.maximum(np.linalg.norm(across, axis=1), 1e-12)
        unit = across / double_area[:, None]
        sides = [np.cross(unit, side) for side in (c - b, a - c, b - a)]  # gradients of the corners' hats times 2 area
        area = self._around @ double_area
        normals = self._around @ across
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)

        def gradient(values: np.ndarray) -> np.ndarray:
            corners = values[self._faces]
            flow = sum(corners[:, k, None] * sides[k] for k in range(3))
            return (self._around @ flow) / area[:, None]

        facing = normals @ direction
        w = direction - facing[:, None] * normals
        sine = np.linalg.norm(w, axis=1)
        bend = (gradient(facing) * w).sum(axis=1)
        for _ in range(_SMOOTHING):
            bend = self._average @ bend
        slope = (gradient(bend) * w).sum(axis=1) / np.maximum(sine, 1e-9)
        return bend, slope, sine


def _paths(links: np.ndarray) -> list[np.ndarray]:
    """Pairs of numbers (k, 2), each number in at most two of them, as paths; a closed path ends where it starts."""
    neighbours: dict[int, list[int]] = {}
    for one, other in links.tolist():
        neighbours.setdefault(one, []).append(other)
        neighbours.setdefault(other, []).append(one)
    paths = []
    # Ends first: what is left after the open paths are the closed ones.
    for start in sorted(neighbours, key=lambda number: len(neighbours[number])):
        if start not in neighbours:
            continue
        path, at = [start], start
        while neighbours.get(at):
            following = neighbours[at].pop()
            neighbours[following].remove(at)
            if not neighbours[at]:
                del neighbours[at]
            path.append(following)
            at = following
        neighbours.pop(at, None)
        paths.append(np.array(path))
    return paths
