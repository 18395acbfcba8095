"""A face drawn as a sketch: the predefined curves, projected, and wrinkles (paper 4.1, Sketch Rendering)."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ..geometry.view import View
from ..sketch import FEATURES, SILHOUETTE, WRINKLE, Segment, Sketch, resample
from .template import Template
from .wrinkles import LIPS, Wrinkles

_SEGMENTS = {"brow": 2, "upper": 3, "lower": 3, "ear": 2, "nose": 3}  # pieces of a feature line, by the end of its name
_LIP_SEGMENTS = 2
_OUTLINE_POINTS = 180
_OUTLINE_SMOOTHING = 2.5  # points; the handle runs along vertices, a pen does not


def outline(points: np.ndarray) -> np.ndarray:
    """The silhouette as a pen would draw it: (180, 2) smooth closed points from projected handle points (k, 2)."""
    even = resample(points, _OUTLINE_POINTS)
    smooth = gaussian_filter1d(even[:-1], _OUTLINE_SMOOTHING, axis=0, mode="wrap")
    return np.concatenate([smooth, smooth[:1]])


def draw(template: Template, vertices: np.ndarray, view: View, wrinkles: Wrinkles | None) -> Sketch:
    """The lines of a head (V, 3) in a view, each feature line as several neighbouring segments (paper 3.2)."""
    lines = {name: view.project(vertices[path]) for name, path in template.curves.items()}
    segments = [Segment(SILHOUETTE, outline(lines[SILHOUETTE]))]
    for name in FEATURES:
        segments += [Segment(name, piece) for piece in _split(lines[name], _SEGMENTS[name.rsplit("_", 1)[-1]])]
    if wrinkles is not None:
        for name in LIPS:
            segments += [Segment(WRINKLE, piece) for piece in _split(lines[name], _LIP_SEGMENTS)]
        segments += [Segment(WRINKLE, line) for line in wrinkles(vertices, view, list(lines.values()))]
    return Sketch(tuple(segments))


def _split(points: np.ndarray, count: int) -> list[np.ndarray]:
    """A polyline in `count` pieces of as many points; neighbours share no point, so that a small gap parts them."""
    return [piece for piece in np.array_split(points, count) if len(piece) > 1]
