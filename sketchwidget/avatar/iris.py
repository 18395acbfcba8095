"""What eyes look like: iris and pupil as the portrait has them, on white."""

from __future__ import annotations

import cv2
import numpy as np

from ..geometry.camera import Camera
from ..geometry.smoothstep import smoothstep
from ..portrait.landmarks import EYES, FaceLandmarks
from .eyes import Eyeball

_WHITE = np.array([238.0, 234.0, 230.0])
_PUPIL, _RING, _RING_DARK = 0.42, 0.86, 0.45  # of the iris's radius: the pupil's, where its dark rim begins, how dark
_COLOURED = (0.5, 0.85)  # the part of the iris whose colour counts
_SHARES = (0.30, 0.62)  # least and greatest radius of the iris, of the eyeball's
_USUAL = 0.45
_LEAST_LIGHT = 55.0  # of the iris: small pictures show little more than lids' shadow
_HIGHLIGHT, _HIGHLIGHT_SIZE = np.array([-0.38, 0.42]), 0.16  # of the iris's radius; upwards
_SOFT = 0.05


def iris_radius(eye: Eyeball, marks: FaceLandmarks, camera: Camera) -> float:
    """Radius of the iris in millimetres: the portrait's where it is known, never out of proportion."""
    known = marks.irises.get(eye.side)
    share = _USUAL if known is None else float(known[2]) / camera.scale / eye.radius
    return float(np.clip(share, *_SHARES)) * eye.radius


def iris_colour(image: np.ndarray, eye: Eyeball, marks: FaceLandmarks) -> np.ndarray:
    """Median colour (3,), 0 to 255, of what the lids show of the iris; hazel if nothing is seen of it."""
    corners = marks.points[EYES[eye.side]]
    lids = marks.eyelids.get(eye.side, corners)
    x, y, radius = marks.irises.get(eye.side, (*lids.mean(axis=0), 0.4 * np.ptp(lids[:, 1])))
    row, column = np.mgrid[: image.shape[0], : image.shape[1]] + 0.5
    away = np.hypot(column - x, row - y) / max(radius, 1e-6)
    open_part = np.zeros(image.shape[:2], dtype=np.uint8)
    cv2.fillPoly(open_part, [np.rint(lids).astype(np.int32)], 1)
    seen = (away > _COLOURED[0]) & (away < _COLOURED[1]) & (open_part > 0)
    colour = np.median(image[seen], axis=0) if seen.any() else np.array([110.0, 84.0, 56.0])
    return colour * max(1.0, _LEAST_LIGHT / max(float(colour.mean()), 1.0))


def paint(angle: np.ndarray, around: np.ndarray, share: float, colour: np.ndarray) -> np.ndarray:
    """Colour of points of an eyeball.

    Parameters
    ----------
    angle : (...) array
        Radians from the axis of the eye.
    around : (..., 2) array
        Unit vectors from the axis, x to the right and y up as the viewer sees them.
    share : float
        Radius of the iris, of the eyeball's.
    colour : (3,) array
        Of the iris.

    Returns
    -------
    (..., 3) array
        0 to 255.
    """
    radius = angle / np.arcsin(share)
    place = radius[..., None] * around
    iris = colour * (1.25 - 0.5 * np.clip(place[..., 1:] + 0.5, 0, 1))  # the upper lid's shadow
    iris = iris * (1 - _RING_DARK * _step(radius, _RING)[..., None])
    painted = iris + _step(radius, 1.0)[..., None] * (_WHITE - iris)
    painted = painted * _step(radius, _PUPIL)[..., None] + 14.0 * (1 - _step(radius, _PUPIL)[..., None])
    light = 1 - _step(np.linalg.norm(place - _HIGHLIGHT, axis=-1), _HIGHLIGHT_SIZE)[..., None]
    return painted + light * (250.0 - painted)


def _step(value: np.ndarray, at: float) -> np.ndarray:
    """0 below a threshold, 1 above it, softly."""
    return smoothstep((value - at) / (2 * _SOFT) + 0.5)
