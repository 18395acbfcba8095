"""Caricatures: an exaggerated head from the 68 landmarks of a picture, by examples of normal faces alone."""

from .camera import Camera
from .exaggeration import exaggerate
from .fitting import CaricatureFit, Step, fit

__all__ = ["Camera", "CaricatureFit", "Step", "exaggerate", "fit"]
