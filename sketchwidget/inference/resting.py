"""A mouth that nobody has drawn yet is at rest, whatever else a drawing makes likely."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..face.model import FaceModel
from ..sketch import SILHOUETTE
from .shape_code import split_lines

_MOUTH, _KEPT = slice(48, 68), slice(17, 48)  # landmarks: those of the mouth; brows, nose and eyes
_OFF = 0.2  # mm by which landmarks may miss where they are wanted, beside a standard deviation of every weight


def mouth_may_be_drawn(
    strokes: Sequence[np.ndarray], names: Sequence[str], places: Sequence[str], points: np.ndarray
) -> bool:
    """Whether any of some strokes (k, 2) is a mouth, or might be one that was taken for something else.

    Rather none is put to rest than one that is drawn. So this is whatever lies in the outline and goes below the eyes;
    what was taken for an eye, a brow or a nose, no broader than a mouth, may do so as far as the nose does. And where
    all but the outline is outside, the outline itself may be the mouth.

    Parameters
    ----------
    strokes : sequence of (k, 2) arrays
    names : sequence of str
        The line that each stroke was named after.
    places : sequence of str
        Whereabouts of each stroke: "inside", "ear" or "outside" the outline.
    points : (n, 2) array
        Of the head's lines, as `sketchwidget.inference.shape_code.sample` gives them, where the strokes are.
    """
    inside = [
        (stroke, name)
        for stroke, name, place in zip(strokes, names, places, strict=True)
        if place == "inside" and name != SILHOUETTE
    ]
    if not inside:
        return "outside" in places
    lines = split_lines(points)
    eyes, mouth = max(lines[f"{side}_eye_lower"][:, 1].max() for side in ("left", "right")), lines["mouth_upper"]
    under_nose = (lines["nose"][:, 1].max() + mouth[:, 1].mean()) / 2

    def may_be_one(stroke: np.ndarray, name: str) -> bool:
        other = "eye" in name or "brow" in name or (name == "nose" and np.ptp(stroke[:, 0]) <= np.ptp(mouth[:, 0]))
        return "mouth" in name or bool(stroke[:, 1].max() > (under_nose if other else eyes))

    return any(may_be_one(stroke, name) for stroke, name in inside)


class MouthAtRest:
    """Takes the mouth of a head of one model to rest, and leaves brows, nose and eyes as they are; the jaw follows.

    Parameters
    ----------
    model : FaceModel
    basis : (3 l, k) array
        Of the coordinates of the model's landmarks.
    spread : (q,) array
        Standard deviations of the expression weights.
    """

    def __init__(self, model: FaceModel, basis: np.ndarray, spread: np.ndarray) -> None:
        self._core, self._basis, self._spread = model.bilinear.core, basis, spread
        self._rest = model.expression_weights("neutral")

    def __call__(self, identity: np.ndarray, expression: np.ndarray) -> np.ndarray:
        """Expression weights (q,) near given ones with which a person's mouth is at rest: linear least squares."""
        by_expression = (self._basis @ (identity @ self._core)).reshape(-1, 3, len(expression)) * self._spread
        mouth, kept = (by_expression[at].reshape(-1, len(expression)) / _OFF for at in (_MOUTH, _KEPT))
        normal = mouth.T @ mouth + kept.T @ kept + np.eye(len(expression))
        wanted = mouth.T @ (mouth @ ((self._rest - expression) / self._spread))
        return expression + self._spread * np.linalg.solve(normal, wanted)
