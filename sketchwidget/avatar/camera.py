"""The camera of a portrait: weak perspective, from millimetres to pixels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Camera:
    """Orthographic projection after a rotation: the pose ``p = (R, t)`` and the projection of equation 4.

    Parameters
    ----------
    rotation : (3, 3) array
        From the head's frame to the viewer's: x right, y up, z to the viewer.
    scale : float
        Pixels to the millimetre.
    translation : (2,) array
        Where the head's origin falls, in pixels, y down.
    """

    rotation: np.ndarray
    scale: float
    translation: np.ndarray

    def project(self, points: np.ndarray) -> np.ndarray:
        """Points in millimetres (n, 3) as pixels (n, 2)."""
        return self.scale * (np.asarray(points) @ self.rotation[:2].T) * (1, -1) + self.translation

    def depth(self, points: np.ndarray) -> np.ndarray:
        """How near points (n, 3) are to the viewer, (n,) millimetres."""
        return np.asarray(points) @ self.rotation[2]

    def lift(self, shift: np.ndarray) -> np.ndarray:
        """Shifts in pixels (n, 2) as shifts of the head's points (n, 3) that keep the depth: equation 11."""
        return (shift * (1, -1) / self.scale) @ self.rotation[:2]

    @property
    def yaw(self) -> float:
        """Degrees that the head is turned to the picture's right."""
        return float(np.degrees(np.arctan2(self.rotation[0, 2], self.rotation[2, 2])))

    @classmethod
    def of(cls, points: np.ndarray, pixels: np.ndarray, weights: np.ndarray) -> Camera:
        """The camera that shows points (n, 3) nearest to pixels (n, 2), each with a weight (n,).

        An affine camera by least squares, then the scaled rotation that is nearest to it.
        """
        root = np.sqrt(weights)[:, None]
        homogeneous = np.column_stack([points, np.ones(len(points))])
        affine = np.linalg.lstsq(root * homogeneous, root * pixels * (1, -1), rcond=None)[0].T
        left, singular, right = np.linalg.svd(affine[:, :3], full_matrices=False)
        rows = left @ right
        rotation = np.stack([*rows, np.cross(*rows)])
        scale = float(singular.mean())
        centre = (weights[:, None] * points).sum(axis=0) / weights.sum()
        seen = (weights[:, None] * pixels).sum(axis=0) / weights.sum()
        return cls(rotation, scale, seen - scale * (rotation[:2] @ centre) * (1, -1))
