"""Mesh mathematics: arrays in, arrays out. Knows nothing of faces."""

from .view import CANVAS_MM, View, rotation_about_y

__all__ = ["CANVAS_MM", "View", "rotation_about_y"]
