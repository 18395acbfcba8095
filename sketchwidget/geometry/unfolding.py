"""Takes the folds out of a mesh that was moved in the plane (Lipman 2012; Boyd et al. 2011)."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import igl
import numpy as np
from scipy import sparse

from .banded import BandedCholesky
from .plane_maps import PlaneMaps, in_plane, incidence, least_stretch

_FOLDED, _OPEN = 0.05, 0.2  # least stretch of a triangle that counts as folded, and of one that is opened again
_NARROW = 0.5  # of a coarse triangle that may have folds within
_WATCHED = 0.5  # of one that may fold while others open
_RINGS = 6  # of vertices about folds that give way
_PULL, _HARDER = 30.0, 1.2  # of watched triangles, against what is about them; and how much more in each stage
_STAGES, _ROUNDS = 20, 8
_STAYS = 1e-6  # of the energy of a vertex that moves by 1


class Unfolding:
    """Moves what is about the folds of a displaced surface so that no triangle is turned over; its handles stay.

    A map of the plane is ``z -> a z + b conj(z)`` on each triangle; its least stretch is ``|a| - |b|``, and where that
    is negative the triangle is turned over. The correction is the one with the least Dirichlet energy for which all
    triangles are in the convex cone ``Re a / turn - |b| >= bound`` (Lipman 2012, *Bounded distortion mapping spaces for
    triangular meshes*). Alternating directions find it (Boyd et al. 2011, section 3): the projection of each triangle,
    and one linear solution, whose matrix stays. They end once nothing is turned over.

    Only triangles that are narrow take part: others would hold the surface back where it is. If a few rounds are not
    enough, the next stage takes those along that became narrow, lets each cone turn to where the surface about its
    triangle has turned, and pulls harder.

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
        self._beside = sparse.csr_matrix(self._stiffness, dtype=np.int8, copy=True)
        self._beside.data[:] = 1
        self._refine, self._handles = sparse.csr_matrix(refine), sparse.csr_matrix(handles)
        self._scouts, self._surface, self._softness = scouts, surface, softness
        self._rigid = lru_cache(maxsize=4)(self._energy)
        self._shape: tuple[int, int] = refine.shape
        by_vertex = incidence(surface, self._shape[0]) @ abs(self._refine)
        self._moved_by = by_vertex.T.tocsr().astype(bool)

    def __call__(self, points: np.ndarray, displacement: np.ndarray, held: np.ndarray) -> np.ndarray:
        """How the points are displaced in x and y by the mesh, without the folds that it would make.

        Parameters
        ----------
        points : (v, 3) array
            Of the surface before.
        displacement : (n, 2) array
            Of the mesh.
        held : (h,) bool array
            The handles that stay where the displacement takes them.

        Returns
        -------
        (v, 2) array
            Where handles leave no room for a triangle, it stays folded.
        """
        before, moves = in_plane(points), self._refine @ in_plane(displacement)
        after = before + moves
        scouts = PlaneMaps(points, self._scouts)
        narrow = scouts.facing(np.flatnonzero(least_stretch(scouts(after)) < _NARROW))
        suspects = PlaneMaps(points, self._moved(self._about(self._scouts[narrow], rings=0)))
        folded = suspects.facing(np.flatnonzero(least_stretch(suspects(after)) < _FOLDED))
        if len(folded):
            free = self._about(suspects.triangles[folded], _RINGS)
            moves += self._correction(free, held, PlaneMaps(points, self._moved(free)), after)
        return np.stack([np.real(moves), np.imag(moves)], axis=1)

    def _about(self, triangles: np.ndarray, rings: int) -> np.ndarray:
        """The vertices (k,) of the mesh that move triangles of points, and some rings about them."""
        near = np.zeros(self._shape[1], dtype=bool)
        near[self._refine[triangles.ravel()].indices] = True
        for _ in range(rings):
            near = self._beside @ near > 0
        return np.flatnonzero(near)

    def _moved(self, free: np.ndarray) -> np.ndarray:
        """The triangles (t, 3) of the surface that vertices move."""
        moved = np.zeros(len(self._surface), dtype=bool)
        moved[self._moved_by[free].indices] = True
        return self._surface[moved]

    def _energy(self, held: bytes) -> Any:
        """Of displacements of the mesh (n, n), with the handles that stay."""
        handles = self._handles[np.frombuffer(held, dtype=bool)]
        rest = _STAYS * sparse.identity(self._shape[1])  # where nothing is held, it could be anywhere
        return self._stiffness + handles.T @ handles / self._softness + rest

    def _correction(self, free: np.ndarray, held: np.ndarray, surface: PlaneMaps, after: np.ndarray) -> np.ndarray:
        """How points (v,) in the plane are displaced further by free vertices that unfold triangles."""
        maps = start = surface(after)
        watched = np.zeros(len(maps), dtype=bool)
        turns, multipliers = np.ones(len(maps), dtype=complex), np.zeros_like(maps)
        rigid = self._rigid(held.tobytes())[free][:, free]
        correction = np.zeros((len(free), 2))
        moves = np.zeros(self._shape[0], dtype=complex)
        for stage in range(_STAGES):
            least = least_stretch(maps)
            watched[surface.facing(np.flatnonzero(least < _WATCHED))] = True
            if (least[watched] > _FOLDED).all():
                break
            if stage:
                turns, multipliers = surface.turns(maps), multipliers / _HARDER
            rows = np.flatnonzero(watched)
            slopes, points = surface.slopes(rows)
            gradient = (slopes @ self._refine[points][:, free]).tocsr()
            weights = 2 * _PULL * _HARDER**stage * surface.areas[rows]
            correction, multipliers[rows] = _opened(
                rigid, gradient, weights, start[rows], turns[rows], multipliers[rows], correction
            )
            everywhere = np.zeros(self._shape[1], dtype=complex)
            everywhere[free] = in_plane(correction)
            moves = self._refine @ everywhere
            maps = surface(after + moves)
        return moves


def _opened(
    rigid: Any,
    gradient: Any,
    weights: np.ndarray,
    start: np.ndarray,
    turns: np.ndarray,
    multipliers: np.ndarray,
    correction: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """A few rounds of alternating directions.

    Parameters
    ----------
    rigid : (k, k) sparse matrix
        Of the energy of corrections.
    gradient : (t, k) sparse complex matrix
        Takes corrections to changes of maps.
    weights : (t,) array
        Of the triangles in the energy.
    start : (t, 2) complex array
        Their maps without a correction.
    turns : (t,) complex array
        How their cones are turned.
    multipliers : (t, 2) complex array
        So far.
    correction : (k, 2) array
        So far.

    Returns
    -------
    correction : (k, 2) array
    multipliers : (t, 2) complex array
    """
    back = gradient.conj()
    back.data *= np.repeat(weights, np.diff(gradient.indptr))
    back = back.T.tocsr()
    factor = BandedCholesky(rigid + 2 * np.real(back @ gradient))
    for _ in range(_ROUNDS):
        moved = in_plane(correction)
        maps = start + gradient @ np.stack([moved, moved.conj()], axis=1)
        if (least_stretch(maps) > _FOLDED).all():
            break
        nearest = _nearest(maps + multipliers, turns)
        multipliers = multipliers + maps - nearest
        pull = back @ (nearest - multipliers - start)
        pull = pull[:, 0] + pull[:, 1].conj()
        correction = factor.solve(np.stack([np.real(pull), np.imag(pull)], axis=1))
    return correction, multipliers


def _nearest(maps: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """The nearest maps (t, 2) that stretch enough everywhere; those that turn far but do not fold stay as they are."""
    along, across = maps[:, 0] * turns.conj(), maps[:, 1]
    size = np.abs(across)
    lacking = np.where(np.abs(along) - size < _OPEN, np.maximum(_OPEN - np.real(along) + size, 0.0), 0.0) / 2
    less = np.minimum(lacking, size)
    return np.stack([(along + 2 * lacking - less) * turns, across * (1 - less / np.maximum(size, 1e-12))], axis=1)
