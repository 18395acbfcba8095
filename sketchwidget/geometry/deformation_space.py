"""The deformation space that examples span (Wu et al. 2018, Alive Caricature, 3.2 and 3.3)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .deformation_representation import Deformation, DeformationRepresentation


class DeformationSpace:
    """Deformations that are weighted sums of those of examples: rotations by one set of weights, stretches by another.

    Weights are arrays (2, k): for each of k examples one for its rotations and one for its scale and shear.

    Parameters
    ----------
    representation : DeformationRepresentation
    examples : sequence of k (n, 3) arrays
        Meshes of the reference's topology; their place and orientation do not matter.

    Raises
    ------
    ValueError
        If there are none, or one is no such mesh.
    """

    def __init__(self, representation: DeformationRepresentation, examples: Sequence[np.ndarray]) -> None:
        if not len(examples):
            raise ValueError("a deformation space needs at least one example")
        self.representation = representation
        basis = [representation.encode(example) for example in examples]
        self._rotations = np.stack([deformation.rotations for deformation in basis], axis=-1)
        self._stretches = np.stack([deformation.stretches for deformation in basis], axis=-1)

    @property
    def size(self) -> int:
        """Number k of examples."""
        return self._rotations.shape[-1]

    def deformation(self, weights: np.ndarray) -> Deformation:
        """Weighted sum of the examples' deformations, by weights (2, k)."""
        weights = np.asarray(weights, dtype=np.float64)
        if weights.shape != (2, self.size) or not np.isfinite(weights).all():
            raise ValueError(f"weights of {self.size} examples are finite (2, {self.size}); given {weights!r}")
        return Deformation(self._rotations @ weights[0], self._stretches @ weights[1])

    def gradients(self, weights: np.ndarray) -> np.ndarray:
        """Deformation gradients (n, 3, 3) of weights (2, k), equation 5."""
        return self.deformation(weights).gradients

    def vertices(self, weights: np.ndarray) -> np.ndarray:
        """The mesh (n, 3) of weights (2, k), equation 8."""
        return self.representation.reconstruct(self.gradients(weights))

    def jacobian(self, weights: np.ndarray) -> np.ndarray:
        """Derivatives (n, 3, 3, 2, k) of the gradients by the weights, equation 10.

        ``d exp(r) = exp(r) [J dr]_x`` with ``J = I - (1 - cos t) / t^2 [r]_x + (t - sin t) / t^3 [r]_x^2`` for an angle
        t (the right Jacobian of SO(3)).
        """
        deformation = self.deformation(weights)
        angle = np.linalg.norm(deformation.rotations, axis=1)
        small = angle < 1e-4
        t = np.where(small, 1.0, angle)
        first = np.where(small, 0.5, (1 - np.cos(t)) / t**2)[:, None, None]
        second = np.where(small, 1 / 6, (t - np.sin(t)) / t**3)[:, None, None]
        skew = -np.cross(deformation.rotations[:, None, :], np.eye(3))
        right = np.eye(3) - first * skew + second * skew @ skew
        # What each axis of an angular velocity does to the columns of I + stretches: (n, 3 rows, 3 columns, 3 axes).
        columns = (np.eye(3) + deformation.stretches).swapaxes(1, 2)
        crossed = -np.cross(np.eye(3)[:, None, :], columns[:, None, :, :])
        by_rotation = (deformation.turns @ crossed.reshape(-1, 3, 9)).reshape(-1, 9, 3) @ right @ self._rotations
        by_stretch = deformation.turns @ self._stretches.reshape(-1, 3, 3 * self.size)
        both = (part.reshape(self._stretches.shape) for part in (by_rotation, by_stretch))
        return np.stack(list(both), axis=-2)

    def normal_equations(self, weights: np.ndarray, vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of the energy (equation 6) in the weights, a mesh being given.

        Parameters
        ----------
        weights : (2, k) array
        vertices : (n, 3) array

        Returns
        -------
        normal : (2 k, 2 k) array
            ``J^T J`` over all edges.
        gradient : (2 k,) array
            ``J^T r``.
        jacobian : (n, 3, 3, 2 k) array
            Of the gradients.
        """
        representation = self.representation
        by_weights = self.jacobian(weights).reshape(-1, 3, 3, 2 * self.size)
        left = self.gradients(weights) @ representation.covariance - representation.spread(vertices)
        gradient = left.ravel() @ by_weights.reshape(-1, 2 * self.size)
        # Over all edges e of a vertex, sums of (D e)^2 are those of (D root)^2.
        rooted = representation.root[:, None] @ by_weights.astype(np.float32)
        rooted = rooted.reshape(-1, 2 * self.size)
        return (rooted.T @ rooted).astype(np.float64), gradient, by_weights
