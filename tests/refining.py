"""Gestures on a head of the shipped model, without a network for its shape."""

import numpy as np

from sketchwidget.gesture.shapes import EXAMPLES


def drawn(name, middle, size=0.15):
    """An example of a gesture about a place of the canvas."""
    shape = EXAMPLES[name]
    low, high = shape.min(axis=0), shape.max(axis=0)
    return middle + (shape - (low + high) / 2) * size / (high - low).max()


def stroke(start, end):
    return np.linspace(start, end, 20)


def about(face, landmark, radius):
    """The vertices within so many millimetres of a landmark."""
    return np.flatnonzero(np.linalg.norm(face.vertices - face.landmarks[landmark], axis=1) < radius)
