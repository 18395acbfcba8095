"""What is known of a face in a picture, and who can find it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from ..geometry.finite import check_finite

RIGHT_EYE, LEFT_EYE = slice(36, 42), slice(42, 48)  # the subject's, of the 68 landmarks in iBUG order
EYES = {"right": RIGHT_EYE, "left": LEFT_EYE}
OUTER_EYE_CORNERS = (36, 45)
CONTOURS = (
    slice(0, 17),
    slice(17, 22),
    slice(22, 27),
)  # jaw and brows: landmarks with no place of their own along them


@dataclass(frozen=True, eq=False)
class FaceLandmarks:
    """The marks of one face, in pixels of its picture: x to the right, y down.

    Parameters
    ----------
    points : (68, 2) array
        In iBUG order: the subject's right jaw first, then brows, nose, eyes, mouth.
    eyelids : dict of (k, 2) arrays
        Closed contour of the open eye by the subject's side, "left" and "right", where it is known; from the outer
        corner along the lower lid to the inner corner, which is the point k / 2, and back along the upper lid.
    irises : dict of (3,) arrays
        Middle and radius of the iris by side, where they are known.
    score : float
        How sure the detector is that this is a face, 0 to 1.

    Raises
    ------
    ValueError
        If the landmarks are not 68 finite points, or lie in one place.
    """

    points: np.ndarray
    eyelids: dict[str, np.ndarray] = field(default_factory=dict)
    irises: dict[str, np.ndarray] = field(default_factory=dict)
    score: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", check_points(self.points))

    @property
    def eye_distance(self) -> float:
        """Pixels between the outer corners of the eyes, the unit of errors of landmarks."""
        right, left = self.points[list(OUTER_EYE_CORNERS)]
        return float(np.linalg.norm(right - left))

    def moved(self, transform: Any) -> FaceLandmarks:
        """The marks after ``transform``, which maps points (n, 2) to points (n, 2), locally a similarity."""
        irises = {}
        for side, (x, y, radius) in self.irises.items():
            middle, edge = transform(np.array([[x, y], [x + radius, y]]))
            irises[side] = np.array([*middle, np.linalg.norm(edge - middle)])
        eyelids = {side: transform(contour) for side, contour in self.eyelids.items()}
        return FaceLandmarks(transform(self.points), eyelids, irises, self.score)

    def snapped(self) -> FaceLandmarks:
        """The marks with each eye landmark on the nearest point of the eyelid's contour, where that is known.

        Section 3.2.1 of *Generating Animatable 3D Cartoon Faces*; the corners go to the contour's own corners.
        """
        points = self.points.copy()
        for side, contour in self.eyelids.items():
            at = EYES[side]
            points[at] = nearest_on_contour(points[at], contour)
        return FaceLandmarks(points, self.eyelids, self.irises, self.score)


def slid(points: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Landmarks `wanted` (68, 2) with those of jaw and brows moved along their line to where `points` (68, 2) are.

    Nothing marks where along a jaw or a brow its landmarks lie, and every annotator spreads them in his own way.
    """
    slid = wanted.copy()
    for line in CONTOURS:
        slid[line] = nearest_on_contour(points[line], wanted[line], closed=False)
    return slid


class FaceDetector(Protocol):
    """Finds faces and their landmarks; any object with these two methods serves."""

    def faces(self, image: np.ndarray) -> np.ndarray:
        """Boxes (k, 4) of the faces in a picture (H, W, 3) uint8: left, top, width, height in pixels, largest first."""
        ...

    def landmarks(self, image: np.ndarray, box: np.ndarray) -> FaceLandmarks:
        """The marks of the face in a box (4,)."""
        ...


def check_points(points: Any) -> np.ndarray:
    """Landmarks as a (68, 2) float64 array; a ValueError says what is wrong with them."""
    given = np.asarray(points, dtype=np.float64)
    check_finite(given, (68, 2), "landmarks are 68 finite points (68, 2) in pixels", "landmark")
    if np.ptp(given, axis=0).min() < 1.0:
        raise ValueError("the landmarks lie in one line or point: they are pixels of the picture, x first")
    return given


def nearest_on_contour(points: np.ndarray, contour: np.ndarray, closed: bool = True) -> np.ndarray:
    """For each point (n, 2) the nearest one (n, 2) on a polygon (k, 2)."""
    start, along = contour, np.roll(contour, -1, axis=0) - contour
    if not closed:
        start, along = start[:-1], along[:-1]
    length = np.maximum((along**2).sum(axis=1), 1e-12)
    share = np.clip(((points[:, None] - start) * along).sum(axis=2) / length, 0.0, 1.0)
    on_sides = start + share[..., None] * along
    distance = np.linalg.norm(on_sides - points[:, None], axis=2)
    return on_sides[np.arange(len(points)), distance.argmin(axis=1)]
