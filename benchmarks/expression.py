"""What a head shows, read off its landmarks and its outline, beside the same person at rest."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import sketchwidget as sw
from sketchwidget.sketch import SILHOUETTE

_CORNERS, _UPPER_LIP, _INNER = [48, 54], 51, (62, 66)
_BROWS, _INNER_BROWS, _OUTER_BROWS = list(range(17, 27)), [21, 22], [17, 26]
_EYE_CORNERS = [36, 39, 42, 45]
_LIDS = {"right": ([37, 38], [41, 40]), "left": ([43, 44], [47, 46])}


def corner_lift(points: np.ndarray) -> float:
    """Height, in mm, of the corners of the mouth over the middle of the upper lip."""
    return points[_CORNERS, 1].mean() - points[_UPPER_LIP, 1]


def mouth_gap(points: np.ndarray) -> float:
    """Between the lips, in mm."""
    return points[_INNER[0], 1] - points[_INNER[1], 1]


def brow_height(points: np.ndarray) -> float:
    """Over the corners of the eyes, in mm."""
    return points[_BROWS, 1].mean() - points[_EYE_CORNERS, 1].mean()


def brow_slant(points: np.ndarray) -> float:
    """Height, in mm, of the inner ends of the brows over the outer ones."""
    return points[_INNER_BROWS, 1].mean() - points[_OUTER_BROWS, 1].mean()


def eye_gap(points: np.ndarray, side: str) -> float:
    """Between the lids, in mm."""
    upper, lower = _LIDS[side]
    return points[upper, 1].mean() - points[lower, 1].mean()


def proportions(face: sw.Face) -> tuple[float, float]:
    """Height over width of a head's outline, and the jaw's breadth over the greatest at the height of the eyes."""
    outline = face.curve(SILHOUETTE)[:, :2]
    height, width = np.ptp(outline[:, 1]), np.ptp(outline[:, 0])

    def breadth(share: float) -> float:
        level = np.abs(outline[:, 1] - outline[:, 1].min() - share * height) < 0.06 * height
        return float(np.ptp(outline[level, 0]))

    return height / width, breadth(0.18) / breadth(0.55)


class Reading:
    """A head compared with the same identity at rest, and with the mean face.

    Parameters
    ----------
    face : Face
    """

    def __init__(self, face: sw.Face) -> None:
        rest, mean = face.model.face(face.identity), face.model.face()
        self.now, self.rest = face.landmarks, rest.landmarks
        self.tall, self.jaw = np.array(proportions(rest)) / proportions(mean)

    def change(self, measure: Callable[[np.ndarray], float]) -> float:
        """How a measure differs from rest."""
        return measure(self.now) - measure(self.rest)

    def open_eye(self, side: str) -> float:
        """Share of its opening at rest."""
        return eye_gap(self.now, side) / eye_gap(self.rest, side)

    def shows(self, meaning: str) -> bool:
        """Whether a viewer would say that the head is what a drawing means; the words are those of `MEANINGS`."""
        return bool(MEANINGS[meaning](self))


MEANINGS: dict[str, Callable[[Reading], bool]] = {
    "neutral": lambda head: abs(head.change(corner_lift)) < 2.0 and head.change(mouth_gap) < 3.0,
    "smile": lambda head: head.change(corner_lift) > 1.0,
    "sad": lambda head: head.change(corner_lift) < -1.0,
    "open": lambda head: head.change(mouth_gap) > 5.0,
    "raised": lambda head: head.change(brow_height) > 1.5,
    "frown": lambda head: head.change(brow_slant) < -1.0,
    "worried": lambda head: head.change(brow_slant) > 1.0,
    "shut": lambda head: max(head.open_eye("left"), head.open_eye("right")) < 0.5,
    "wink": lambda head: head.open_eye("left") < 0.5 < head.open_eye("right"),
    "long": lambda head: head.tall > 1.04,
    "broad": lambda head: head.tall < 0.96,
    "jowly": lambda head: head.jaw > 1.05,
    "narrow": lambda head: head.jaw < 0.97,
}
