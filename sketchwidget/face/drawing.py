"""A face drawn as a sketch: the predefined curves, projected, and wrinkles (paper 4.1, Sketch Rendering)."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial import KDTree

from ..geometry.view import View
from ..sketch import FEATURES, SILHOUETTE, WRINKLE, Piece, Segment, Sketch, arc_length, resample
from .template import Template
from .wrinkles import LIPS, Wrinkles

# Pieces that a line is drawn in, by the end of its name; the silhouette is whole.
_PIECES = {"silhouette": 1, "brow": 2, "eye_upper": 3, "eye_lower": 3, "mouth_upper": 3, "mouth_lower": 3, "ear": 2}
_PIECES |= {"nose": 3, "lip_upper": 2, "lip_lower": 2}
_OUTLINE_POINTS = 180
_OUTLINE_SMOOTHING = 2.5  # points; the handle runs along vertices, a pen does not


def outline(points: np.ndarray) -> np.ndarray:
    """The silhouette as a pen would draw it: (180, 2) smooth closed points from projected handle points (k, 2)."""
    even = resample(points, _OUTLINE_POINTS)
    smooth = gaussian_filter1d(even[:-1], _OUTLINE_SMOOTHING, axis=0, mode="wrap")
    return np.concatenate([smooth, smooth[:1]])


def outline_weights(points: np.ndarray) -> np.ndarray:
    """What `outline` does to handle points (k, 2), as weights (180, k): linear while arc lengths keep their shares."""
    return along_outline(points, np.eye(len(points)))


def along_outline(points: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values (180, d) along the `outline` of handle points (k, 2), which have the given ones (k, d)."""
    along = arc_length(points)
    wanted = np.linspace(0.0, along[-1], _OUTLINE_POINTS)
    even = np.stack([np.interp(wanted, along, one) for one in values.T], axis=1)
    smooth = gaussian_filter1d(even[:-1], _OUTLINE_SMOOTHING, axis=0, mode="wrap")
    return np.concatenate([smooth, smooth[:1]])


def draw(template: Template, vertices: np.ndarray, view: View, wrinkles: Wrinkles | None) -> Sketch:
    """The lines of a head (V, 3) in a view, each feature line as several neighbouring segments (paper 3.2)."""
    lines = {name: view.project(vertices[path]) for name, path in template.curves.items()}
    segments = [Segment(SILHOUETTE, outline(lines[SILHOUETTE]))]
    for name in FEATURES:
        segments += [Segment(name, piece) for piece in split_line(name, lines[name])]
    if wrinkles is not None:
        for name in LIPS:
            segments += [Segment(WRINKLE, piece) for piece in split_line(name, lines[name])]
        segments += [Segment(WRINKLE, line) for line in wrinkles(vertices, view, list(lines.values()))]
    return Sketch(tuple(segments))


def editable(template: Template, vertices: np.ndarray, view: View) -> Sketch:
    """The lines of a head (V, 3) in a view as pieces that know their handle points, to be edited (paper 3.2).

    Other than in `draw`, smoothing does not shrink the silhouette: what is edited is where its handle points go.
    """
    lines = {name: view.project(vertices[path]) for name, path in template.curves.items()}
    even = resample(lines[SILHOUETTE], _OUTLINE_POINTS)[:-1]
    # Twice what smoothing gives, less what it gives of that: what is wider than a step of the mesh keeps its size.
    once = gaussian_filter1d(even, _OUTLINE_SMOOTHING, axis=0, mode="wrap")
    smooth = 2 * once - gaussian_filter1d(once, _OUTLINE_SMOOTHING, axis=0, mode="wrap")
    smooth = np.concatenate([smooth, smooth[:1]])
    at = _places(smooth, lines[SILHOUETTE])
    segments: list[Segment] = [Piece(SILHOUETTE, smooth, at)]
    for name in FEATURES:
        places = np.arange(len(lines[name]))
        segments += [Piece(name, lines[name][part], part) for part in split_line(name, places)]
    return Sketch(tuple(segments))


def _places(smooth: np.ndarray, handle: np.ndarray) -> np.ndarray:
    """The place of each point of a closed line (n, 2) among the handle points (k, 2), each at its nearest point."""
    dense = resample(smooth, 20 * len(smooth))
    nearest = np.asarray(KDTree(dense).query(handle)[1]) / (len(dense) - 1)
    nearest[0], nearest[-1] = 0.0, 1.0
    share = arc_length(smooth)
    return np.interp(share / share[-1], np.maximum.accumulate(nearest), np.arange(len(handle)))


def split_line(name: str, points: np.ndarray) -> list[np.ndarray]:
    """A line (n, d) in the pieces that it is drawn in; neighbours share no point, so that a small gap parts them."""
    count = next(count for ending, count in _PIECES.items() if name.endswith(ending))
    return [piece for piece in np.array_split(points, count) if len(piece) > 1]
