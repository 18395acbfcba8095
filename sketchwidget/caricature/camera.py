"""The weak-perspective camera of a picture (Wu et al. 2018, Alive Caricature, equation 11)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

DOWN = np.array([1.0, -1.0])  # in a picture y goes down


@dataclass(frozen=True, eq=False)
class Camera:
    """From millimetres to the pixels of a picture: ``scale * (rotation @ point)[:2] * (1, -1) + translation``.

    Parameters
    ----------
    scale : float
        Pixels to the millimetre.
    rotation : (3, 3) array
        From the head's frame to the viewer's: x right, y up, z to the viewer.
    translation : (2,) array
        Pixels; y down.
    """

    scale: float
    rotation: np.ndarray
    translation: np.ndarray

    def project(self, points: np.ndarray) -> np.ndarray:
        """Points in millimetres (..., 3) as pixels (..., 2)."""
        return self.scale * (np.asarray(points) @ self.rotation[:2].T) * DOWN + self.translation

    def targets(self, pixels: np.ndarray) -> np.ndarray:
        """Pixels (..., 2) as millimetres in the viewer's plane (..., 2), y up."""
        return (pixels - self.translation) * DOWN / self.scale

    def centred(self, points: np.ndarray, pixels: np.ndarray, weights: np.ndarray) -> Camera:
        """This camera moved to where points (n, 3) are nearest to pixels (n, 2), weighted (n,)."""
        missed = np.average(pixels - self.project(points), axis=0, weights=weights)
        return replace(self, translation=self.translation + missed)

    @classmethod
    def fitted(cls, points: np.ndarray, pixels: np.ndarray, weights: np.ndarray, start: Camera | None = None) -> Camera:
        """The camera that projects points nearest to given pixels, by least squares.

        Parameters
        ----------
        points : (n, 3) array
        pixels : (n, 2) array
        weights : (n,) array
            Of the squared distances; at least four points that count, not in one plane.
        start : Camera, optional
            By default the nearest one to the best affine camera.
        """
        root = np.sqrt(weights)[:, None]
        middle, centre = (np.average(each, axis=0, weights=weights) for each in (points, pixels))
        points, plane = root * (points - middle), root * (pixels - centre) * DOWN
        if start is None:
            affine = np.linalg.lstsq(points, plane, rcond=None)[0].T
            left, stretch, right = np.linalg.svd(affine, full_matrices=False)
            rows = left @ right
            first, scale = np.vstack([rows, np.cross(*rows)]), float(stretch.mean())
        else:
            first, scale = start.rotation, start.scale
        size = np.linalg.norm(plane)

        def residuals(change: np.ndarray) -> np.ndarray:
            turned = Rotation.from_rotvec(change[:3]).as_matrix() @ first
            return ((scale * np.exp(change[3]) * points @ turned[:2].T - plane) / size).ravel()

        change = least_squares(residuals, np.zeros(4), method="lm").x
        scale = float(scale * np.exp(change[3]))
        rotation = Rotation.from_rotvec(change[:3]).as_matrix() @ first
        return cls(scale, rotation, centre - scale * (rotation[:2] @ middle) * DOWN)
