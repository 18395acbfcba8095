"""What a face is: template, bilinear model, and a face drawn as a sketch."""

from .face import Face
from .model import FaceModel
from .template import PARTS, Template

__all__ = ["PARTS", "Face", "FaceModel", "Template"]
