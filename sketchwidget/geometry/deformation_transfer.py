"""Deformation transfer: a pose of one mesh carried to another of the same topology (Sumner and Popovic 2004)."""

from __future__ import annotations

import igl
import numpy as np
from scipy.sparse.linalg import splu


def deformation_gradients(rest: np.ndarray, posed: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Affine part of each triangle's motion, the normal as its third direction.

    Parameters
    ----------
    rest, posed : (n, 3) arrays
    faces : (m, 3) int array

    Returns
    -------
    (m, 3, 3) array
        ``Q`` with ``Q @ (rest edge) = posed edge``, and the fourth vertex (Sumner and Popovic, equation 2) mapped
        likewise.
    """
    return _frames(posed, faces) @ np.linalg.inv(_frames(rest, faces))


def _frames(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = (np.asarray(vertices, dtype=np.float64)[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    if not (length > 0).all():
        raise ValueError(f"deformation gradients need triangles with area; {int((length == 0).sum())} have none")
    return np.stack([b - a, c - a, normal / np.sqrt(length)], axis=-1)


class DeformationTransfer:
    """Carries deformation gradients to a target at rest, with some vertices held where they are.

    The fourth vertex of each target triangle is free, so that it always meets its gradient along the normal; what is
    left is a Poisson problem in the area-weighted tangential gradients, with one factorisation for all right-hand
    sides.

    Parameters
    ----------
    rest : (n, 3) array
        The target at rest.
    faces : (m, 3) int array
    held : (n,) bool array
        Vertices that stay at rest; at least one in each connected component.
    """

    def __init__(self, rest: np.ndarray, faces: np.ndarray, held: np.ndarray) -> None:
        self._rest = np.asarray(rest, dtype=np.float64)
        self._held = np.asarray(held, dtype=bool)
        if self._held.shape != (len(self._rest),) or not self._held.any():
            raise ValueError("deformation transfer holds at least one vertex in place; held is (n,) bool")
        faces = np.asarray(faces, dtype=np.int64)
        area = 0.5 * np.asarray(igl.doublearea(self._rest, faces))
        if not (area > 0).all():
            raise ValueError(f"deformation transfer needs triangles with area; {int((~(area > 0)).sum())} have none")
        gradient = igl.grad(self._rest, faces)  # rows: x of all faces, then y, then z
        area = np.tile(area, 3)
        divergence = gradient.T.multiply(area[None, :]).tocsr()
        laplacian = (divergence @ gradient).tocsc()
        free = ~self._held
        self._divergence = divergence[free]
        self._border = laplacian[free][:, self._held] @ self._rest[self._held]
        self._solver = splu(laplacian[free][:, free], permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})

    def __call__(self, gradients: np.ndarray) -> np.ndarray:
        """Posed targets (..., n, 3) for gradients (..., m, 3, 3)."""
        poses = gradients.reshape(-1, *gradients.shape[-3:])
        # For coordinate k of the pose, the wanted gradient in a face is row k of its deformation gradient.
        wanted = poses.transpose(3, 1, 0, 2).reshape(-1, len(poses) * 3)
        solved = self._solver.solve(self._divergence @ wanted - np.tile(self._border, len(poses)))
        posed = np.broadcast_to(self._rest, (len(poses), *self._rest.shape)).copy()
        posed[:, ~self._held] = solved.reshape(-1, len(poses), 3).transpose(1, 0, 2)
        return posed.reshape(*gradients.shape[:-3], *self._rest.shape)
