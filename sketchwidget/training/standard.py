"""Weights in standardised form, as networks give them: 0 is the mean, 1 a standard deviation."""

from __future__ import annotations

import numpy as np

from ..face.model import FaceModel


def standardisation(model: FaceModel) -> dict[str, np.ndarray]:
    """Mean and standard deviation of a model's identity (p,) and expression (q,) weights, by name."""
    modes = {"identity": model.bilinear.identities, "expression": model.bilinear.expressions}
    return {
        f"{mode}_{name}": statistic
        for mode, weights in modes.items()
        for name, statistic in (("mean", weights.mean(axis=0)), ("std", weights.std(axis=0)))
    }


def standardised_pose(model: FaceModel, expression: np.ndarray) -> np.ndarray:
    """Standardised expression weights (..., q) of weights (..., q)."""
    statistics = standardisation(model)
    return (expression - statistics["expression_mean"]) / statistics["expression_std"]
