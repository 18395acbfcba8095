"""A sketch as a face."""

from .regressor import FaceRegressor, Inference

__all__ = ["FaceRegressor", "Inference"]
