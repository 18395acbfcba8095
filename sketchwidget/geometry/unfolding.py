"""Takes the folds out of a mesh that was moved in the plane (Lipman 2012; Boyd et al. 2011)."""

from __future__ import annotations

from typing import Any

import igl
import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

_FACING = 0.2  # |z| of a normal: other triangles are seen too edge-on to fold
_FOLDED, _OPEN = 0.05, 0.2  # least stretch of a triangle that counts as folded, and of one that is opened again
_NARROW = 0.3  # of a coarse triangle that may have folds within
_RINGS = 5  # of vertices about it that give way
_PULL = 10.0  # of folded triangles, against the surface about them
_ROUNDS = 40


class Unfolding:
    """Moves what is about the folds of a displaced surface so that no triangle is turned over; its handles stay.

    A map of the plane is ``z -> a z + b conj(z)`` on each triangle; its least stretch is ``|a| - |b|``, and where that
    is negative the triangle is turned over. The correction is the one with the least Dirichlet energy for which all
    triangles are in the convex cone ``Re a - |b| >= bound`` (Lipman 2012, *Bounded distortion mapping spaces for
    triangular meshes*). Alternating directions find it (Boyd et al. 2011, section 3): the projection of each triangle,
    and one linear solution, whose matrix stays. They end once nothing is turned over.

    Parameters
    ----------
    rest : (n, 3) array
        The coarse mesh that is displaced, at rest.
    faces : (m, 3) int array
        Its triangles.
    refine : (v, n) sparse matrix
        The points of the surface as combinations of its vertices.
    scouts, surface : (k, 3), (t, 3) int arrays
        Triangles of points: a few large ones that tell where to look, and those that must not be turned over.
    handles : (h, n) sparse matrix
        Each handle as a combination of vertices.
    softness : float
        Of the handles: 0 would not move them at all.
    """

    def __init__(
        self,
        rest: np.ndarray,
        faces: np.ndarray,
        refine: Any,
        scouts: np.ndarray,
        surface: np.ndarray,
        handles: Any,
        softness: float,
    ) -> None:
        self._stiffness = sparse.csr_matrix(-igl.cotmatrix(rest, faces))
        self._refine, self._handles = sparse.csr_matrix(refine), sparse.csr_matrix(handles)
        self._scouts, self._surface, self._softness = scouts, surface, softness
        self._shape: tuple[int, int] = refine.shape

    def __call__(self, points: np.ndarray, displacement: np.ndarray, held: np.ndarray) -> np.ndarray:
        """The displacement (n, 2) of the mesh in x and y without the folds that it would make.

        Parameters
        ----------
        points : (v, 3) array
            Of the surface before.
        displacement : (n, 2) array
        held : (h,) bool array
            The handles that stay where the displacement takes them.

        Returns
        -------
        (n, 2) array
            The same object if there are no folds. Where handles leave no room for a triangle, it stays folded.
        """
        before = _complex(points)
        after = before + self._refine @ _complex(displacement)
        scouts = _facing(points, self._scouts)
        narrow = scouts[_least(_maps(_slopes(before[scouts])[0], after[scouts])) < _NARROW]
        if not len(narrow):
            return displacement
        free = self._about(narrow)
        surface = self._surface[self._moving(free)[self._surface].any(axis=1)]
        surface = _facing(points, surface)
        slopes, areas = _slopes(before[surface])
        maps = _maps(slopes, after[surface])
        if (_least(maps) > _FOLDED).all():
            return displacement
        correction = self._correction(free, held, surface, slopes, areas, maps)
        unfolded = np.array(displacement)
        unfolded[free] += correction
        return unfolded

    def _about(self, triangles: np.ndarray) -> np.ndarray:
        """The vertices (k,) of the mesh that are some rings from triangles of points, at most."""
        near = np.zeros(self._shape[1], dtype=bool)
        near[self._refine[triangles.ravel()].indices] = True
        for _ in range(_RINGS):
            near[self._stiffness[near].indices] = True
        return np.flatnonzero(near)

    def _moving(self, free: np.ndarray) -> np.ndarray:
        """Which points (v,) bool the vertices move."""
        moving = np.zeros(self._shape[1])
        moving[free] = 1.0
        return self._refine @ moving > 0

    def _correction(
        self,
        free: np.ndarray,
        held: np.ndarray,
        surface: np.ndarray,
        slopes: np.ndarray,
        areas: np.ndarray,
        start: np.ndarray,
    ) -> np.ndarray:
        """Displacements (k, 2) of the free vertices that unfold triangles."""
        corners = sparse.csr_matrix(
            (slopes.ravel(), surface.ravel(), np.arange(0, surface.size + 1, 3)), (len(surface), self._shape[0])
        )
        gradient = (corners @ self._refine[:, free]).tocsr()
        back = (gradient.conj().T @ sparse.diags(2 * areas)).tocsr()
        handles = self._handles[held][:, free]
        matrix = self._stiffness[free][:, free] + handles.T @ handles / self._softness
        matrix += 2 * _PULL * np.real(back @ gradient)
        factor = splu(matrix.tocsc(), "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        correction = np.zeros((len(free), 2))
        multipliers = np.zeros_like(start)
        for _ in range(_ROUNDS):
            maps = start + gradient @ _with_conjugate(_complex(correction))
            if (_least(maps) > _FOLDED).all():
                break
            opened = _opened(maps + multipliers)
            multipliers += maps - opened
            pull = back @ (opened - multipliers - start)
            pull = _PULL * (pull[:, 0] + pull[:, 1].conj())
            correction = factor.solve(np.stack([np.real(pull), np.imag(pull)], axis=1))
        return correction


def _complex(points: np.ndarray) -> np.ndarray:
    return points[:, 0].astype(np.float64) + 1j * points[:, 1]


def _facing(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Those of some triangles (k, 3) that are seen well enough from the front or from behind."""
    corners = points[triangles]
    (x, y, z), (u, v, w) = np.moveaxis(corners[:, 1:] - corners[:, :1], (1, 2), (0, 1))
    across = x * v - y * u
    return triangles[across**2 * (1 / _FACING**2 - 1) > (y * w - z * v) ** 2 + (z * u - x * w) ** 2]


def _slopes(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of triangles (t, 3) in the complex plane: derivatives by z of hat functions (t, 3), and areas (t,)."""
    opposite = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
    double = np.imag(np.conj(corners[:, 1] - corners[:, 0]) * (corners[:, 2] - corners[:, 0]))
    return np.conj(1j * opposite) / (2 * double[:, None]), np.abs(double) / 2


def _with_conjugate(values: np.ndarray) -> np.ndarray:
    return np.stack([values, values.conj()], axis=-1)


def _maps(slopes: np.ndarray, after: np.ndarray) -> np.ndarray:
    """a and conj(b) (t, 2) of the maps that take triangles to their corners (t, 3)."""
    return np.einsum("tc,tck->tk", slopes, _with_conjugate(after))


def _least(maps: np.ndarray) -> np.ndarray:
    """The least stretch (t,) of maps (t, 2), negative where they turn over."""
    return np.abs(maps[:, 0]) - np.abs(maps[:, 1])


def _opened(maps: np.ndarray) -> np.ndarray:
    """The nearest maps (t, 2) that stretch enough everywhere; those that turn far but do not fold stay as they are."""
    along, across = maps.T
    size = np.abs(across)
    lacking = np.where(_least(maps) < _OPEN, _OPEN - along.real + size, 0.0) / 2
    less = np.minimum(lacking, size)
    return np.stack([along + 2 * lacking - less, across * (1 - less / np.maximum(size, 1e-12))], axis=1)
