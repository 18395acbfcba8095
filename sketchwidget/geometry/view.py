"""The camera of the whole house: from millimetres to the canvas."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

CANVAS_MM = 250.0  # millimetres to the canvas unit: a 200 mm face height is 0.8 of the canvas

_SMALLER, _HIGHER = 0.88, 0.03  # a head in a picture than in the canonical frame; see `View.of_head`

_YAW = {"front": 0.0, "left": -90.0, "right": 90.0, "three-quarter": -40.0}  # degrees about y


@dataclass(frozen=True)
class View:
    """An orthographic view: a rotation, then a scaling onto the canvas.

    Parameters
    ----------
    rotation : (3, 3) array
        Rotation from the head's frame (x to the subject's left, y up, z to the front) to the viewer's.
    scale : float
        Canvas units per millimetre.
    centre : (2,) array
        Where the head's origin falls on the canvas (x right, y down, the canvas is the unit square).

    Examples
    --------
    >>> sw.View().project([[0.0, 0.0, 50.0], [125.0, 62.5, 0.0]]).tolist()  # 250 mm to the unit, y down
    [[0.5, 0.5], [1.0, 0.25]]
    """

    rotation: np.ndarray = field(default_factory=lambda: np.eye(3, dtype=np.float32))
    scale: float = 1.0 / CANVAS_MM
    centre: np.ndarray = field(default_factory=lambda: np.array([0.5, 0.5], dtype=np.float32))

    def __post_init__(self) -> None:
        rotation = np.asarray(self.rotation, dtype=np.float32)
        centre = np.asarray(self.centre, dtype=np.float32)
        if rotation.shape != (3, 3) or not np.abs(rotation @ rotation.T - np.eye(3)).max() < 1e-4:
            raise ValueError(f"a view's rotation is an orthonormal (3, 3) matrix; given {rotation.tolist()}")
        if centre.shape != (2,) or not np.isfinite(centre).all():
            raise ValueError(f"a view's centre is a finite point (2,); given {self.centre!r}")
        if not (np.isfinite(self.scale) and self.scale > 0):
            raise ValueError(f"a view's scale is a positive number of canvas units per mm; given {self.scale!r}")
        object.__setattr__(self, "rotation", rotation)
        object.__setattr__(self, "centre", centre)
        object.__setattr__(self, "scale", float(self.scale))

    @classmethod
    def preset(cls, name: str) -> View:
        """A named view: front, left, right (the subject's sides) or three-quarter, in the canonical frame."""
        if name not in _YAW:
            raise ValueError(f"a view is one of {', '.join(_YAW)}; given {name!r}")
        return cls(rotation_about_y(_YAW[name]))

    @classmethod
    def of_head(cls, name: str) -> View:
        """A named view of the whole head, for pictures: as `preset` has it, but smaller and higher, so that necks fit.

        The canonical frame has the face in its middle: the neck of the mean head ends below it.
        """
        return cls(cls.preset(name).rotation, _SMALLER / CANVAS_MM, np.array([0.5, 0.5 - _HIGHER]))

    def project(self, points: np.ndarray) -> np.ndarray:
        """Points in millimetres (..., 3) as canvas points (..., 2)."""
        seen = np.asarray(points, dtype=np.float32) @ self.rotation[:2].T
        return self.centre + self.scale * seen * np.array([1, -1], dtype=np.float32)


def rotation_about_y(degrees: float) -> np.ndarray:
    """Rotation (3, 3) about the upward axis; positive turns the nose towards the subject's left."""
    angle = np.radians(degrees)
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]], dtype=np.float32)
