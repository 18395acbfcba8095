"""Takes the folds out of a mesh that was moved in the plane (Lipman 2012; Boyd et al. 2011)."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import igl
import numpy as np
from scipy import sparse

from .banded import BandedCholesky
from .plane_maps import PlaneMaps, in_plane, least_stretch, signed_areas

_FOLDED, _OPEN = 0.05, 0.2  # least stretch of a triangle that counts as folded, and of one that is opened again
_SHRUNK = 0.3  # of its area: what is left of a triangle that may count as folded
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
        Its triangles, of vertices that move points.
    refine : (v, n) sparse matrix
        The points of the surface as combinations of its vertices.
    surface : (t, 3) int array
        Triangles of points that must not be turned over.
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
        surface: np.ndarray,
        handles: Any,
        softness: float,
    ) -> None:
        self._stiffness = sparse.csr_matrix(-igl.cotmatrix(rest, faces))
        self._near: Any = self._stiffness.astype(bool) ** _RINGS
        self._refine, self._handles = sparse.csr_matrix(refine), sparse.csr_matrix(handles)
        self._moves = self._refine.T.tocsr()
        self._surface = np.asarray(surface, dtype=np.intp, order="F")  # its columns are asked for
        self._softness = softness
        self._rigid = lru_cache(maxsize=4)(self._energy)

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
        moves = self._refine @ in_plane(displacement)
        before = in_plane(points)
        after = before + moves
        areas = signed_areas(before, self._surface)
        shrunk = signed_areas(after, self._surface) * areas < _SHRUNK * areas**2
        suspects = PlaneMaps(points, self._triangles(shrunk))
        folded = suspects.facing(np.flatnonzero(least_stretch(suspects(after)) < _FOLDED))
        if len(folded):
            moves += self._correction(self._about(suspects.triangles[folded]), held, points, after)
        return np.stack([np.real(moves), np.imag(moves)], axis=1)

    def _triangles(self, which: np.ndarray) -> np.ndarray:
        """Some (k, 3) of the surface, told by (t,) bool."""
        return self._surface.T.take(np.flatnonzero(which), axis=1).T

    def _about(self, triangles: np.ndarray) -> np.ndarray:
        """The vertices (k,) of the mesh that move triangles of points, and those of some rings about them."""
        moving = self._refine[np.unique(triangles)].indices
        about = np.zeros(self._near.shape[0], dtype=bool)
        about[self._near[np.unique(moving)].indices] = True
        return np.flatnonzero(about)

    def _energy(self, held: bytes) -> Any:
        """Of displacements of the mesh (n, n), with the handles that stay."""
        handles = self._handles[np.frombuffer(held, dtype=bool)]
        rest = _STAYS * sparse.identity(self._near.shape[0])  # where nothing is held, it could be anywhere
        return self._stiffness + handles.T @ handles / self._softness + rest

    def _correction(self, free: np.ndarray, held: np.ndarray, points: np.ndarray, after: np.ndarray) -> np.ndarray:
        """How points (v,) in the plane are displaced further by free vertices that unfold triangles."""
        refine = self._moves[free].T.tocsr()
        moved = np.diff(refine.indptr) > 0
        surface = PlaneMaps(points, self._triangles(moved[self._surface.T].any(axis=0)))
        maps = start = surface(after)
        watched = np.zeros(len(maps), dtype=bool)
        turns, multipliers = np.ones(len(maps), dtype=complex), np.zeros_like(maps)
        rigid = self._rigid(held.tobytes())[free][:, free]
        correction = np.zeros((len(free), 2))
        moves = np.zeros(len(after), dtype=complex)
        for stage in range(_STAGES):
            least = least_stretch(maps)
            watched[surface.facing(np.flatnonzero(least < _WATCHED))] = True
            if (least[watched] > _FOLDED).all():
                break
            if stage:
                turns, multipliers = surface.turns(maps), multipliers / _HARDER
            rows = np.flatnonzero(watched)
            gradient = (surface.slopes(rows) @ refine).tocsr()
            weights = 2 * _PULL * _HARDER**stage * surface.areas[rows]
            correction, multipliers[rows] = _opened(
                rigid, gradient, weights, start[rows], turns[rows], multipliers[rows], correction
            )
            moves = refine @ in_plane(correction)
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
