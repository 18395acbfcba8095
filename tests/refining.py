"""Gestures on a head, for tests."""

import numpy as np

from sketchwidget.gesture.shapes import example


def drawn(name, middle, size=0.15):
    """An example of a gesture about a place of the canvas."""
    return example(name, middle, size)


def stroke(start, end):
    return np.linspace(start, end, 20)


def about(face, landmark, radius):
    """The vertices within so many millimetres of a landmark."""
    return np.flatnonzero(np.linalg.norm(face.vertices - face.landmarks[landmark], axis=1) < radius)
