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

    Attributes
    ----------
    areas : (t,) array
        Before.
    """

    def __init__(self, points: np.ndarray, triangles: np.ndarray) -> None:
        self.triangles = triangles
        self._points = points
        one, other = _sides(in_plane(points), triangles)
        areas = _areas(one, other)
        self.areas = np.abs(areas)
        per_area = 0.25j / np.where(areas == 0, 1e-12, areas)  # none if a triangle is seen edge-on
        # What each side that a triangle gets adds to a; its conjugate adds the same to conj(b).
        self._one, self._other = per_area * other.conj(), -per_area * one.conj()

    def __call__(self, after: np.ndarray) -> np.ndarray:
        """a and conj(b) (t, 2) for points that are displaced to complex places (v,)."""
        one, other = _sides(after, self.triangles)
        maps = np.empty((len(self.triangles), 2), dtype=complex)
        maps[:, 0] = self._one * one + self._other * other
        maps[:, 1] = self._one * one.conj() + self._other * other.conj()
        return maps

    def facing(self, rows: np.ndarray) -> np.ndarray:
        """Those of some triangles that are seen well enough from the front or from behind."""
        corners = self._points[self.triangles[rows]]
        (x, y, z), (u, v, w) = np.moveaxis(corners[:, 1:] - corners[:, :1], (1, 2), (0, 1))
        across = x * v - y * u
        return rows[across**2 * (1 / _FACING**2 - 1) > (y * w - z * v) ** 2 + (z * u - x * w) ** 2]

    def slopes(self, rows: np.ndarray) -> sparse.csr_matrix:
        """What takes displacements of the points to changes of a, for some triangles: (k, v) complex."""
        one, other = self._one[rows], self._other[rows]
        slopes = np.stack([-one - other, one, other], axis=1)
        return _by_corners(slopes, self.triangles[rows], len(self._points))

    def turns(self, maps: np.ndarray) -> np.ndarray:
        """By which unit complex numbers (t,) the surface about each triangle is turned.

        A triangle that is folded does not tell by itself; those that share its corners do.
        """
        corners = _by_corners(np.ones(self.triangles.shape), self.triangles, len(self._points))
        around = corners @ (corners.T @ (maps[:, 0] * self.areas))
        return around / np.maximum(np.abs(around), 1e-12)


def in_plane(points: np.ndarray) -> np.ndarray:
    """x and y of points (n, 2 or 3) as complex numbers."""
    return points[:, 0].astype(np.float64) + 1j * points[:, 1]


def signed_areas(places: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Of triangles (t, 3) of complex places (v,), negative where their corners go round clockwise."""
    return _areas(*_sides(places, triangles))


def least_stretch(maps: np.ndarray) -> np.ndarray:
    """The least stretch (t,) of maps (t, 2), negative where they turn over."""
    return np.abs(maps[:, 0]) - np.abs(maps[:, 1])


def _by_corners(values: np.ndarray, triangles: np.ndarray, count: int) -> sparse.csr_matrix:
    """Values (t, 3) at the corners of triangles (t, 3) as a matrix (t, count), so many points being there."""
    ends = np.arange(0, triangles.size + 1, 3)
    return sparse.csr_matrix((values.ravel(), triangles.ravel(), ends), (len(triangles), count))


def _sides(places: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of triangles: the two sides from the first corner on."""
    first = places[triangles[:, 0]]
    return places[triangles[:, 1]] - first, places[triangles[:, 2]] - first


def _areas(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Of triangles with these sides."""
    return (np.real(one) * np.imag(other) - np.imag(one) * np.real(other)) / 2
