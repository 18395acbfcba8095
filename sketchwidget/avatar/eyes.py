"""Eyeballs: spheres behind the lids, which turn as a whole (section 4.3, Eye-ball Modeling)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..face.model import FaceModel
from ..face.template import PARTS

SIDES = ("left", "right")
# Degrees at full weight; the sign of pitch is upwards, that of yaw towards the subject's left.
TURNS = _UP, _DOWN, _ASIDE = 24.0, 28.0, 30.0


@dataclass(frozen=True, eq=False)
class Eyeball:
    """One eye.

    Parameters
    ----------
    side : str
        The subject's, "left" or "right".
    vertices : (k,) int array
        Its vertices of the fine mesh.
    directions : (k, 3) array
        Where these lie on the unit sphere while the eye looks straight ahead.
    centre : (3,) array
        Millimetres.
    radius : float
        Millimetres.
    """

    side: str
    vertices: np.ndarray
    directions: np.ndarray
    centre: np.ndarray
    radius: float

    def points(self, weights: Mapping[str, float] | None = None) -> np.ndarray:
        """Its vertices (k, 3), turned by the gaze among ARKit weights."""
        return self.centre + self.radius * self.directions @ self.rotation(weights or {}).T

    def rotation(self, weights: Mapping[str, float]) -> np.ndarray:
        """The turn (3, 3) that gaze weights ask for."""
        up, down, inwards, outwards = (weights.get(name, 0.0) for name in gaze_names(self.side))
        pitch = np.radians(_UP * up - _DOWN * down)
        yaw = np.radians(_ASIDE * (outwards - inwards)) * (1 if self.side == "left" else -1)
        about_x = np.array([[1, 0, 0], [0, np.cos(pitch), np.sin(pitch)], [0, -np.sin(pitch), np.cos(pitch)]])
        about_y = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
        return about_y @ about_x


def gaze_names(side: str) -> tuple[str, ...]:
    """ARKit's names of what turns an eye: up, down, in, out."""
    return tuple(f"eyeLook{way}{side.capitalize()}" for way in ("Up", "Down", "In", "Out"))


def fit_eyeballs(model: FaceModel, head: np.ndarray, before: np.ndarray) -> list[Eyeball]:
    """A sphere behind the lids of each eye.

    Parameters
    ----------
    model : FaceModel
    head : (V, 3) array
        Fine vertices of the head.
    before : (V, 3) array
        The same head before its landmarks were aligned: its eyeballs fit its lids.

    Returns
    -------
    list of Eyeball
        The subject's left eye first. As large as the aligned opening asks for, and touching its lids from behind.
    """
    found = []
    parts = model.template.fine_parts
    for side in SIDES:
        upper, lower = model.curves[f"{side}_eye_upper"], model.curves[f"{side}_eye_lower"]
        margin = np.unique(np.concatenate([upper, lower]))
        sign = 1 if side == "left" else -1
        vertices = np.flatnonzero((parts == PARTS.index("eyes")) & (sign * model.mean[:, 0] > 0))
        ball = before[vertices].astype(np.float64)
        centre, radius = sphere(ball)
        directions = ball - centre
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)

        lids, old = head[margin].astype(np.float64), before[margin].astype(np.float64)
        radius *= max(1.0, float(np.ptp(lids[:, 0]) / np.ptp(old[:, 0])))
        centre[:2] += (lids.mean(axis=0) - old.mean(axis=0))[:2]
        aside = ((lids[:, :2] - centre[:2]) ** 2).sum(axis=1)
        facing = aside < (0.95 * radius) ** 2
        centre[2] = (lids[facing, 2] - np.sqrt(radius**2 - aside[facing])).min()
        found.append(Eyeball(side, vertices, directions, centre, radius))
    return found


def sphere(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Centre (3,) and radius of the sphere nearest to points (n, 3), by linear least squares."""
    known = np.column_stack([2 * points, np.ones(len(points))])
    *centre, rest = np.linalg.lstsq(known, (points**2).sum(axis=1), rcond=None)[0]
    centre = np.array(centre)
    return centre, float(np.sqrt(rest + centre @ centre))


def set_back(eye: Eyeball, distance: float) -> Eyeball:
    """The eye moved into the head by the paper's Delta, in millimetres."""
    return Eyeball(eye.side, eye.vertices, eye.directions, eye.centre - (0, 0, distance), eye.radius)
