"""How the triangles of a surface are mapped by a displacement in the plane."""

from __future__ import annotations

import numpy as np
from scipy import sparse

_FACING = 0.2  # |z| of a normal: other triangles are seen too edge-on to fold


class PlaneMaps:
    """The maps ``z -> a z + b conj(z)`` of the plane by which triangles go to where their corners are displaced.

    Parameters
    ----------
    points : (v, 3) array
        Before; x and y tell the place in the plane.
    triangles : (t, 3) int array
        Of points.
    """

    def __init__(self, points: np.ndarray, triangles: np.ndarray) -> None:
        self.triangles = triangles
        self._points = points
        self._before = in_plane(points)
        one, other = _sides(self._before, triangles)
        across = one * other.conj() - other * one.conj()
        self._across = np.where(across == 0, 1e-12j, across)  # of a triangle that is seen edge-on
        self._one, self._other = one, other

    def __call__(self, after: np.ndarray) -> np.ndarray:
        """a and conj(b) (t, 2) for points that are displaced to complex places (v,)."""
        one, other = _sides(after, self.triangles)
        along = (one * self._other.conj() - other * self._one.conj()) / self._across
        across = (self._one * other - self._other * one) / self._across
        return np.stack([along, across.conj()], axis=1)

    @property
    def areas(self) -> np.ndarray:
        """Before, (t,)."""
        return np.abs(self._across) / 4

    def facing(self, rows: np.ndarray) -> np.ndarray:
        """Those of some triangles that are seen well enough from the front or from behind."""
        corners = self._points[self.triangles[rows]]
        (x, y, z), (u, v, w) = np.moveaxis(corners[:, 1:] - corners[:, :1], (1, 2), (0, 1))
        across = x * v - y * u
        return rows[across**2 * (1 / _FACING**2 - 1) > (y * w - z * v) ** 2 + (z * u - x * w) ** 2]

    def slopes(self, rows: np.ndarray) -> tuple[sparse.csr_matrix, np.ndarray]:
        """What takes displacements of some points to changes of a, for some triangles.

        Returns
        -------
        (k, p) sparse complex matrix
        (p,) int array
            The points.
        """
        corners = self.triangles[rows]
        points, place = np.unique(corners, return_inverse=True)
        sides = np.stack([self._one[rows] - self._other[rows], self._other[rows], -self._one[rows]], axis=1).conj()
        slopes = sides / self._across[rows, None]
        ends = np.arange(0, corners.size + 1, 3)
        return sparse.csr_matrix((slopes.ravel(), place.ravel(), ends), (len(rows), len(points))), points

    def turns(self, maps: np.ndarray) -> np.ndarray:
        """By which unit complex numbers (t,) the surface about each triangle is turned.

        A triangle that is folded does not tell by itself; those that share its corners do.
        """
        corners = incidence(self.triangles, len(self._points))
        around = corners @ (corners.T @ (maps[:, 0] * self.areas))
        return around / np.maximum(np.abs(around), 1e-12)


def in_plane(points: np.ndarray) -> np.ndarray:
    """x and y of points (n, 2 or 3) as complex numbers."""
    return points[:, 0].astype(np.float64) + 1j * points[:, 1]


def incidence(triangles: np.ndarray, count: int) -> sparse.csr_matrix:
    """Which of so many points (t, count) are corners of triangles (t, 3)."""
    ends = np.arange(0, triangles.size + 1, 3)
    return sparse.csr_matrix((np.ones(triangles.size), triangles.ravel(), ends), (len(triangles), count))


def least_stretch(maps: np.ndarray) -> np.ndarray:
    """The least stretch (t,) of maps (t, 2), negative where they turn over."""
    return np.abs(maps[:, 0]) - np.abs(maps[:, 1])


def _sides(places: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of triangles: the two sides from the first corner on."""
    first = places[triangles[:, 0]]
    return places[triangles[:, 1]] - first, places[triangles[:, 2]] - first
