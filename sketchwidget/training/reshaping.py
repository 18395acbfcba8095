"""Heads of other proportions than the database has: people draw rounder, squarer and more pointed outlines."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..face.model import FaceModel
from ..geometry.smoothstep import smoothstep
from .face_table import lines_of


class Reshaping:
    """Makes heads broader and longer, with broader and narrower jaws and crowns, in their points and their codes alike.

    People draw outlines that are rounder, squarer and more pointed than most heads are.

    Parameters
    ----------
    model : FaceModel
    """

    def __init__(self, model: FaceModel) -> None:
        basis, mean = model.bilinear.basis, model.bilinear.mean
        x, y, _ = mean.reshape(-1, 3).T
        lines = lines_of(model)
        everywhere, sides = np.ones_like(x), smoothstep(np.abs(x), 20.0, 55.0)
        # Axis and, for each coarse vertex, how much it takes part.
        ways = {
            "width": (0, everywhere),
            "height": (1, everywhere),
            "jaw": (0, sides * smoothstep(-y, 10.0, 75.0)),
            "crown": (0, sides * smoothstep(y, 10.0, 75.0)),
        }
        # Scaling an axis about the origin is an affine map of the code: by a matrix and a constant for a unit of scale.
        self._ways = {
            name: (
                axis,
                lines @ share,
                basis[axis::3].T @ (share[:, None] * basis[axis::3]),
                basis[axis::3].T @ (share * mean[axis::3]),
            )
            for name, (axis, share) in ways.items()
        }

    def __call__(
        self, points: np.ndarray, code: np.ndarray, amounts: Mapping[str, float]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Points (p, 3) and code (k,) reshaped one way after the other.

        Parameters
        ----------
        points : (p, 3) array
        code : (k,) array
        amounts : mapping of float
            By "width", "height", "jaw" and "crown": 0.1 makes that tenth larger.
        """
        points = points.copy()
        for name, amount in amounts.items():
            axis, share, linear, constant = self._ways[name]
            points[:, axis] *= 1 + amount * share
            code = code + amount * (linear @ code + constant)
        return points, code
