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
        Where the head's origin falls, in pixels; y down.
    """

    scale: float
    rotation: np.ndarray
    translation: np.ndarray

    def project(self, points: np.ndarray) -> np.ndarray:
        """Points in millimetres (..., 3) as pixels (..., 2)."""
        return self.scale * (np.asarray(points) @ self.rotation[:2].T) * DOWN + self.translation

    def depth(self, points: np.ndarray) -> np.ndarray:
        """How near points (..., 3) are to the viewer, (...,) millimetres."""
        return np.asarray(points) @ self.rotation[2]

    def targets(self, pixels: np.ndarray) -> np.ndarray:
        """Pixels (..., 2) as millimetres in the viewer's plane (..., 2), y up."""
        return (pixels - self.translation) * DOWN / self.scale

    def lift(self, shift: np.ndarray) -> np.ndarray:
        """Shifts in pixels (..., 2) as shifts of points (..., 3), millimetres, that keep the depth."""
        return (shift * DOWN / self.scale) @ self.rotation[:2]

    @property
    def yaw(self) -> float:
        """Degrees that the head is turned to the picture's right."""
        return float(np.degrees(np.arctan2(self.rotation[0, 2], self.rotation[2, 2])))

    def centred(self, points: np.ndarray, pixels: np.ndarray, weights: np.ndarray) -> Camera:
        """This camera moved to where points (n, 3) are nearest to pixels (n, 2), weighted (n,)."""
        missed = np.average(pixels - self.project(points), axis=0, weights=weights)
        return replace(self, translation=self.translation + missed)

    @classmethod
    def from_affine(cls, points: np.ndarray, pixels: np.ndarray, weights: np.ndarray) -> Camera:
        """The camera that is nearest to the best affine one, in one step; parameters are those of `fitted`."""
        middle, centre, points, plane = _centred(points, pixels, weights)
        affine = np.linalg.lstsq(points, plane, rcond=None)[0].T
        left, stretch, right = np.linalg.svd(affine, full_matrices=False)
        rows = left @ right
        return _showing(middle, centre, float(stretch.mean()), np.vstack([rows, np.cross(*rows)]))

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
            By default that of `from_affine`.
        """
        start = start or cls.from_affine(points, pixels, weights)
        middle, centre, points, plane = _centred(points, pixels, weights)
        size = np.linalg.norm(plane)

        def residuals(change: np.ndarray) -> np.ndarray:
            turned = Rotation.from_rotvec(change[:3]).as_matrix() @ start.rotation
            return ((start.scale * np.exp(change[3]) * points @ turned[:2].T - plane) / size).ravel()

        change = least_squares(residuals, np.zeros(4), method="lm").x
        scale = float(start.scale * np.exp(change[3]))
        return _showing(middle, centre, scale, Rotation.from_rotvec(change[:3]).as_matrix() @ start.rotation)


def _centred(
    points: np.ndarray, pixels: np.ndarray, weights: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The means of points and pixels, and both relative to these, by the roots of their weights; pixels with y up."""
    root = np.sqrt(weights)[:, None]
    middle, centre = (np.average(each, axis=0, weights=weights) for each in (points, pixels))
    return middle, centre, root * (points - middle), root * (pixels - centre) * DOWN


def _showing(middle: np.ndarray, centre: np.ndarray, scale: float, rotation: np.ndarray) -> Camera:
    """The camera that shows a point (3,) at a place (2,) of the picture."""
    return Camera(scale, rotation, centre - scale * (rotation[:2] @ middle) * DOWN)
