"""Pictures of faces: safe loading, landmarks and their detectors, masks."""

from .landmarks import FaceDetector, FaceLandmarks
from .picture import load_picture

__all__ = ["FaceDetector", "FaceLandmarks", "load_picture"]
