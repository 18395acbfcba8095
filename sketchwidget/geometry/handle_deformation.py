"""Laplacian surface editing with handles that are known beforehand (Sorkine et al. 2004)."""

from __future__ import annotations

from typing import Any

import igl
import numpy as np
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.linalg import splu


class HandleDeformation:
    """Moves handles of a mesh to targets and keeps the differential coordinates of the rest.

    Displacements `d` minimise ``d' Q d + |C d - t|^2 / softness``: `C` picks the handles, `t` is where they go to, and
    ``Q = L' M^-1 L + anchor M`` measures, with the cotangent Laplacian `L` and the areas `M` of the mesh at rest, how
    much the Laplacian coordinates change and, a little, how far the surface moves. All of this is fixed, so that the
    solution is the product of a dense matrix and the targets.

    Parameters
    ----------
    rest : (n, 3) array
        The mesh whose metric counts.
    faces : (m, 3) int array
    handles : (h, n) sparse matrix
        Each handle as a combination of vertices.
    softness : float
        Of the handles: 0 would meet the targets exactly, and every tremor in them.
    anchor : float
        Of the surface to where it was, in 1 / unit^4: parts further from all handles than about its fourth root stay.
    usual : (h,) bool array, optional
        The handles that are given most often, all by default: for them the solution is one dense product.

    Attributes
    ----------
    handles : (h, n) sparse matrix

    Raises
    ------
    ValueError
        If the shapes do not fit, or softness or anchor are not positive.
    """

    def __init__(
        self,
        rest: np.ndarray,
        faces: np.ndarray,
        handles: Any,
        softness: float,
        anchor: float,
        usual: np.ndarray | None = None,
    ) -> None:
        if handles.shape[1] != len(rest):
            raise ValueError(f"handles of {len(rest)} vertices are a matrix (h, {len(rest)}); given {handles.shape}")
        if not (softness > 0 and anchor > 0):
            raise ValueError(f"softness and anchor are positive; given {softness!r} and {anchor!r}")
        rest, faces = np.asarray(rest, dtype=np.float64), np.asarray(faces, dtype=np.int64)
        self.handles = sparse.csr_matrix(handles, dtype=np.float64)
        self._laplacian = sparse.csr_matrix(igl.cotmatrix(rest, faces))
        areas = np.asarray(igl.massmatrix(rest, faces, igl.MASSMATRIX_TYPE_BARYCENTRIC).diagonal())
        self._by_area = sparse.diags(1 / areas)
        energy = self._laplacian.T @ self._by_area @ self._laplacian + anchor * sparse.diags(areas)
        self._energy = splu(energy.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        self._response = self._energy.solve(self.handles.T.toarray())  # Q^-1 C'
        self._gram = self.handles @ self._response + softness * np.eye(handles.shape[0])
        self._usual = np.ones(handles.shape[0], dtype=bool) if usual is None else np.asarray(usual)
        gram = self._gram[np.ix_(self._usual, self._usual)]
        self._product = (self._response[:, self._usual] @ np.linalg.inv(gram)).astype(np.float32)

    def __call__(self, moves: np.ndarray) -> np.ndarray:
        """Displacements (n, k) of the vertices for displacements (h, k) of the handles.

        A handle whose row is not finite is free.
        """
        moves = np.asarray(moves)
        known = np.isfinite(moves).all(axis=1)
        if (known == self._usual).all():
            return self._product @ moves[known].astype(np.float32)
        if not known.any():
            return np.zeros((len(self._response), moves.shape[1]), dtype=np.float32)
        pull = np.zeros(moves.shape)
        pull[known] = cho_solve(cho_factor(self._gram[np.ix_(known, known)]), moves[known].astype(np.float64))
        return (self._response @ pull).astype(np.float32)

    def turning(self, vertices: np.ndarray, moves: np.ndarray, rounds: int = 2) -> np.ndarray:
        """Displacements (n, 2) in the plane for which Laplacian coordinates turn and grow with the surface.

        Linear editing keeps Laplacian coordinates as they are, so that a detail leans over where its surroundings turn.
        Here each is taken along by the similarity of the plane that is nearest to what its neighbourhood did in the
        round before (as in Sorkine et al. 2004, section 3, where the similarities are part of the unknowns).

        Parameters
        ----------
        vertices : (n, 3) array
            The mesh before.
        moves : (h, 2) array
            Of all handles, in x and y.
        rounds : int
        """
        plane = np.asarray(vertices, dtype=np.float64)[:, :2]
        flat = self._laplacian @ plane
        coordinates = flat[:, 0] + 1j * flat[:, 1]
        displaced = self(moves)
        for _ in range(rounds):
            change = (self._similarities(plane, plane + displaced) - 1) * coordinates
            wanted = self._by_area @ np.stack([np.real(change), np.imag(change)], axis=1)
            free = self._energy.solve(self._laplacian.T @ wanted)
            displaced = free + self(moves - self.handles @ free)
        return displaced.astype(np.float32)

    def _similarities(self, before: np.ndarray, after: np.ndarray) -> np.ndarray:
        """The similarity of the plane about each vertex as a complex number, by least squares over its edges."""
        weights = self._laplacian - sparse.diags(self._laplacian.diagonal())
        weights.data = np.abs(weights.data)
        pairs = weights.tocoo()
        z, w = (points[:, 0] + 1j * points[:, 1] for points in (before, after))
        a, b = z[pairs.col] - z[pairs.row], w[pairs.col] - w[pairs.row]
        count = len(before)
        product = b * a.conj()
        turn, grown = (np.bincount(pairs.row, pairs.data * part(product), count) for part in (np.imag, np.real))
        return (grown + 1j * turn) / np.maximum(np.bincount(pairs.row, pairs.data * np.abs(a) ** 2, count), 1e-12)
