"""The intrinsic deformation representation of one mesh against another (Wu et al. 2018, Alive Caricature, 3.1)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import igl
import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu
from scipy.spatial.transform import Rotation

from .alignment import similarity
from .finite import check_finite

_LEAST_WEIGHT = 1e-3  # of an edge, over the mean: an obtuse triangle's cotangent would be negative
_AROUND = 0.1  # what the neighbours' 1-rings count: one that is nearly flat tells nothing about its normal
_FLAT = 1e-9  # over the trace: where all are flat, normals stay as they are


@dataclass(frozen=True)
class Deformation:
    """Differences of a mesh from a reference, vertex by vertex (equation 3); zero where nothing is deformed.

    Parameters
    ----------
    rotations : (n, 3) array
        Logarithms of the rotations, as rotation vectors: axis times angle.
    stretches : (n, 3, 3) array
        Symmetric scale and shear less the identity.
    """

    rotations: np.ndarray
    stretches: np.ndarray

    @cached_property
    def turns(self) -> np.ndarray:
        """Rotation matrices (n, 3, 3)."""
        return Rotation.from_rotvec(self.rotations).as_matrix()

    @property
    def gradients(self) -> np.ndarray:
        """Deformation gradients (n, 3, 3): rotation times scale and shear."""
        return self.turns @ (np.eye(3) + self.stretches)


class DeformationRepresentation:
    """What turns meshes of one topology into differences from a reference, and back.

    Parameters
    ----------
    reference : (n, 3) array
    faces : (m, 3) int array
        Of one connected piece.

    Raises
    ------
    ValueError
        If the mesh is not one piece or has triangles without area.
    """

    def __init__(self, reference: np.ndarray, faces: np.ndarray) -> None:
        self.reference = np.array(reference, dtype=np.float64)
        faces = np.asarray(faces, dtype=np.int64)
        area = np.asarray(igl.doublearea(self.reference, faces))
        if not (area > 0).all():
            raise ValueError(f"the reference needs triangles with area; {int((~(area > 0)).sum())} have none")
        cotangents = sparse.triu(igl.cotmatrix(self.reference, faces), k=1).tocoo()
        self._start, self._end = cotangents.row, cotangents.col
        self._weights = np.maximum(cotangents.data, _LEAST_WEIGHT * np.abs(cotangents.data).mean())
        count, edges = len(self.reference), len(self._weights)
        ends = np.concatenate([self._start, self._end]), np.tile(np.arange(edges), 2)
        self._at_vertex = sparse.csr_matrix((np.ones(2 * edges), ends), shape=(count, edges))
        signs = np.repeat([1.0, -1.0], edges)
        self._difference = sparse.csr_matrix((signs, ends[::-1]), shape=(edges, count))
        if sparse.csgraph.connected_components(self._at_vertex @ self._at_vertex.T)[0] != 1:
            raise ValueError("the reference is one piece, each of its vertices in a triangle")
        self._edges = np.asarray(self._difference @ self.reference)
        beside = self._at_vertex @ self._at_vertex.T
        beside.setdiag(0)
        self._around = sparse.identity(count) + _AROUND * sparse.diags(1 / np.ravel(beside.sum(axis=1))) @ beside
        self.covariance = self.spread(self.reference)
        trace = np.trace(self.covariance, axis1=1, axis2=2)
        self._flat = _FLAT * trace[:, None, None] * np.eye(3)

    def gradients(self, vertices: np.ndarray) -> np.ndarray:
        """Deformation gradients (n, 3, 3) of a mesh (n, 3), by least squares over each 1-ring (equation 1).

        The 1-rings of the neighbours take part with a small weight: what a nearly flat 1-ring makes of its normal would
        be noise, and extrapolate as such. An affine map is the gradient everywhere, whatever the weight.
        """
        spread, covariance = (
            (self._around @ sums.reshape(-1, 9)).reshape(-1, 3, 3) + self._flat
            for sums in (self.spread(vertices), self.covariance)
        )
        return np.linalg.solve(covariance, spread.transpose(0, 2, 1)).transpose(0, 2, 1)

    def encode(self, vertices: np.ndarray) -> Deformation:
        """The differences of a mesh (n, 3) that was brought onto the reference by a rigid motion (equation 3).

        Raises
        ------
        ValueError
            As `aligned` does.
        """
        return polar(self.gradients(self.aligned(vertices)))

    def aligned(self, vertices: np.ndarray) -> np.ndarray:
        """A mesh (n, 3) moved rigidly to where it is nearest to the reference.

        Raises
        ------
        ValueError
            If it has not as many vertices as the reference, or one is not finite.
        """
        vertices = np.asarray(vertices, dtype=np.float64)
        shape = self.reference.shape
        check_finite(vertices, shape, f"a mesh of this topology has finite vertices {shape}", "vertex")
        _, rotation, _ = similarity(vertices, self.reference)
        return (vertices - vertices.mean(axis=0)) @ rotation.T + self.reference.mean(axis=0)

    def reconstruct(self, gradients: np.ndarray) -> np.ndarray:
        """The mesh (n, 3) whose edges are nearest to what gradients (n, 3, 3) make of the reference's (equation 8).

        Its first vertex is where the reference has it.
        """
        return self.solve(self.divergence(gradients)) + self.reference[0]

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solutions (n, k) of the Laplacian's system for right-hand sides (n, k), the first vertex pinned at zero."""
        solved = np.zeros_like(right)
        solved[1:] = self._factor.solve(np.ascontiguousarray(right[1:]))
        return solved

    def divergence(self, gradients: np.ndarray) -> np.ndarray:
        """Right-hand sides (n, 3, ...) of equation 8, for gradients (n, 3, 3, ...)."""
        count, *rest = gradients.shape[0], *gradients.shape[3:]
        rows = [self._divergence @ gradients[:, row].reshape(3 * count, -1) for row in range(3)]
        return np.stack(rows, axis=1).reshape(count, 3, *rest)

    @cached_property
    def _divergence(self) -> sparse.csr_matrix:
        """From one row of every gradient (3 n,) to one coordinate of the right-hand sides (n,)."""
        halves = (self._weights[:, None] * self._edges / 2).repeat(2, axis=0).ravel()
        ends = 3 * np.stack([self._start, self._end], axis=1)[:, :, None] + np.arange(3)
        edges = np.arange(len(self._edges)).repeat(6)
        shape = len(self._edges), 3 * len(self.reference)
        return sparse.csr_matrix(self._difference.T @ sparse.csr_matrix((halves, (edges, ends.ravel())), shape=shape))

    @cached_property
    def root(self) -> np.ndarray:
        """Symmetric square roots (n, 3, 3) float32 of the covariances of the reference's 1-rings."""
        values, vectors = np.linalg.eigh(self.covariance)
        return ((vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]) @ vectors.swapaxes(1, 2)).astype(np.float32)

    @cached_property
    def laplacian(self) -> sparse.csc_matrix:
        """Matrix (n, n) of equation 8."""
        return sparse.csc_matrix(self._difference.T @ self._difference.multiply(self._weights[:, None]))

    @cached_property
    def _factor(self) -> SuperLU:
        return splu(self.laplacian[1:, 1:], permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})

    def energy(self, vertices: np.ndarray, gradients: np.ndarray) -> float:
        """How far a mesh's edges are from what gradients make of the reference's (equation 6)."""
        deformed = self._difference @ vertices
        return float(
            sum(
                self._weights @ ((deformed - np.einsum("eij,ej->ei", gradients[ends], self._edges)) ** 2).sum(axis=1)
                for ends in (self._start, self._end)
            )
        )

    def spread(self, vertices: np.ndarray) -> np.ndarray:
        """Sums (n, 3, 3) of ``c_ij e'_ij e_ij^T`` about each vertex, of the edges e' of a mesh (n, 3)."""
        deformed = np.asarray(self._difference @ np.asarray(vertices, dtype=np.float64))
        products = self._weights[:, None, None] * deformed[:, :, None] * self._edges[:, None, :]
        return (self._at_vertex @ products.reshape(-1, 9)).reshape(-1, 3, 3)


def polar(gradients: np.ndarray) -> Deformation:
    """Rotation and scale/shear of gradients (n, 3, 3): ``T = R S`` with a proper rotation R (Section 3.1)."""
    left, singular, right = np.linalg.svd(gradients)
    mirrored = np.linalg.det(left @ right) < 0
    left[mirrored, :, 2] *= -1
    singular[mirrored, 2] *= -1
    stretches = right.swapaxes(1, 2) @ (singular[:, :, None] * right) - np.eye(3)
    return Deformation(Rotation.from_matrix(left @ right).as_rotvec(), stretches)
