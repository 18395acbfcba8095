"""The energy of a caricature, and the steps that lower it (Wu et al. 2018, Alive Caricature, equations 13 to 15)."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from ..geometry.camera import DOWN, Camera
from ..geometry.deformation_space import DeformationSpace
from ..geometry.levenberg_marquardt import levenberg_marquardt


class Problem:
    """Deformation energy plus the pull of landmarks in a picture.

    ``sum_ij c_ij |e'_ij - T_i(w) e_ij|^2 + sum_l lambda_l |proj(p'_l) - q_l|^2 / scale^2``, over the vertices p', the
    weights w and the camera. For given weights and camera the best vertices are those of no landmarks plus a few
    fields, one for each landmark, since the Laplacian stays and a rotation's rows are orthonormal (Woodbury). Steps for
    weights and camera let the vertices follow: with vertices held, as in the paper, a step explains what is there
    already, and all creep towards the landmarks together. The camera's translation is eliminated too: landmarks are
    taken relative to their weighted mean.

    Parameters
    ----------
    space : DeformationSpace
        Of n vertices and k examples.
    rows : (l, n) sparse matrix
        Landmarks from vertices.
    pixels : (l, 2) array
        q.
    strengths : (l,) array
        lambda of each landmark, greater than 0.
    """

    def __init__(
        self, space: DeformationSpace, rows: sparse.csr_matrix, pixels: np.ndarray, strengths: np.ndarray
    ) -> None:
        self._space, self._strengths = space, strengths
        centred = np.eye(len(pixels)) - strengths / strengths.sum()
        self._rows = sparse.csr_matrix(centred @ rows)
        self._targets = centred @ pixels * DOWN
        # The deformation energy has each edge twice: half its Hessian is twice the Laplacian.
        self._fields = space.representation.solve(self._rows.T.toarray()) / 2
        self._inverse = np.linalg.inv(self._rows @ self._fields + np.diag(1 / strengths))

    def vertices(self, weights: np.ndarray, camera: Camera) -> np.ndarray:
        """P-step: the best vertices (n, 3) for weights (2, k), equation 15."""
        free = self._space.vertices(weights)
        return free + self._fields @ (self._inverse @ self._misses(free, camera)) @ camera.rotation[:2]

    def energy(self, weights: np.ndarray, camera: Camera) -> float:
        """Equation 14 at the best vertices for weights (2, k)."""
        vertices = self.vertices(weights, camera)
        pull = float(self._strengths @ (self._misses(vertices, camera) ** 2).sum(axis=1))
        return self._space.representation.energy(vertices, self._space.gradients(weights)) + pull

    def weights(self, start: np.ndarray, camera: Camera, iterations: int) -> np.ndarray:
        """w-step: weights (2, k) of less energy, by Levenberg-Marquardt."""

        def cost(flat: np.ndarray) -> float:
            return self.energy(flat.reshape(2, -1), camera)

        def normal_equations(flat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return self.normal_equations(flat.reshape(2, -1), camera)

        return levenberg_marquardt(cost, normal_equations, start.ravel(), iterations).reshape(2, -1)

    def camera(self, weights: np.ndarray, start: Camera) -> Camera:
        """The camera of least energy for weights (2, k)."""
        seen = self._rows @ self._space.vertices(weights)
        # At the best vertices the energy that hangs on the camera is misses^T (K + 1 / lambda)^-1 misses.
        root = np.linalg.cholesky(self._inverse).T

        def moved(change: np.ndarray) -> Camera:
            turned = Rotation.from_rotvec(change[:3]).as_matrix() @ start.rotation
            return Camera(float(start.scale * np.exp(change[3])), turned, start.translation)

        def residuals(change: np.ndarray) -> np.ndarray:
            camera = moved(change)
            return (root @ (self._targets / camera.scale - seen @ camera.rotation[:2].T)).ravel()

        return moved(least_squares(residuals, np.zeros(4), method="lm").x)

    def normal_equations(self, weights: np.ndarray, camera: Camera) -> tuple[np.ndarray, np.ndarray]:
        """Of the energy in the weights (2, k), the vertices following: (2 k, 2 k) and (2 k,) arrays."""
        representation = self._space.representation
        normal, gradient, by_weights = self._space.normal_equations(weights, self.vertices(weights, camera))
        pushes = representation.divergence(by_weights)  # (n, 3, 2 k): how the right-hand sides follow the weights
        size = pushes.shape[2]
        moves = representation.solve(pushes.reshape(len(pushes), -1)).reshape(pushes.shape)
        eliminated = 2 * np.tensordot(pushes, moves, ([0, 1], [0, 1]))
        seen = camera.rotation[:2] @ (self._rows @ moves.reshape(len(moves), -1)).reshape(-1, 3, size)
        held = (self._inverse @ seen.reshape(len(seen), -1)).reshape(seen.shape)
        eliminated -= np.tensordot(seen, held, ([0, 1], [0, 1]))
        return normal - (eliminated + eliminated.T) / 2, gradient

    def _misses(self, vertices: np.ndarray, camera: Camera) -> np.ndarray:
        """What landmarks (l, 2) miss, in millimetres, relative to their mean."""
        return self._targets / camera.scale - self._rows @ vertices @ camera.rotation[:2].T
