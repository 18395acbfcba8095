"""Caricatures: an exaggerated head from the 68 landmarks of a picture, by examples of normal faces alone.

Examples
--------
>>> laugh = sw.FaceModel.load().face(expression="laugh")
>>> landmarks = 2 * laugh.landmarks[:, :2] * [1, -1] + 300  # pixels, y down, iBUG order
>>> fit = sw.caricature.fit(landmarks)
>>> bool(fit.rmse < 4), fit.vertices.shape == laugh.vertices.shape  # pixels
(True, True)
>>> more = sw.caricature.exaggerate(fit.face, 1.5)
"""

from ..geometry.camera import Camera
from .exaggeration import exaggerate
from .fitting import CaricatureFit, Step, fit

__all__ = ["Camera", "CaricatureFit", "Step", "exaggerate", "fit"]
