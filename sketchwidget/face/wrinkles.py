"""Wrinkle lines: suggestive contours of the skin of the face (paper 4.1, Sketch Rendering, and Figure 3 (b))."""

from __future__ import annotations

import cv2
import igl
import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial import KDTree

from ..geometry.suggestive import SuggestiveContours
from ..geometry.view import CANVAS_MM, View
from ..geometry.visibility import visible
from ..sketch import SILHOUETTE, arc_length, resample
from .template import PARTS, Template

LIPS = ("lip_upper", "lip_lower")  # the outer contour of the lips, a wrinkle that every face has

# Suggestive contours: degrees, and 1/mm^2 for a face 200 mm high.
_ANGLE = 12.0
_LEAST, _PEAK = 0.0006, 0.003
_SHORTEST = 7.0  # mm; anything less is a crumb
_STEP, _SMOOTHING = 1.0, 1.5  # mm along a line, and steps: a contour turns at every edge of the mesh, a pen does not
_BESIDE, _ALONG = 5.0, 0.75  # mm from a predefined curve, and cosine with its direction: such a wrinkle is its double

# The region: distances in millimetres about the curves of a typical face seen from the front.
_FROM_OUTLINE, _FROM_EYES, _FROM_LIPS, _FROM_NOSE = 10.0, 3.5, 3.0, 3.0
_ROOT = 28  # landmark on the ridge of the nose, where its root ends
_PIXELS = 2  # of the map, to the millimetre


class Wrinkles:
    """Draws the wrinkles of all heads of one template.

    Parameters
    ----------
    template : Template
    rest : (V, 3) array
        A typical head at rest, millimetres: tells what lies in the region.
    """

    def __init__(self, template: Template, rest: np.ndarray) -> None:
        self._faces = template.faces
        self._contours = SuggestiveContours(template.faces, region(template, rest))

    def __call__(self, vertices: np.ndarray, view: View, drawn: list[np.ndarray]) -> list[np.ndarray]:
        """Wrinkle lines of a head in a view.

        Parameters
        ----------
        vertices : (V, 3) array
            Millimetres.
        view : View
        drawn : list of (k, 2) arrays
            Canvas points of the lines that are drawn anyway: no wrinkle runs along them.

        Returns
        -------
        list of (n, 2) arrays
            Smooth lines on the canvas, hidden parts and crumbs left out.
        """
        contours = self._contours(vertices, view.rotation[2].astype(np.float64), _ANGLE, _LEAST, _PEAK)
        if not contours:
            return []
        ends = np.cumsum([len(contour) for contour in contours])
        seen = np.split(visible(np.concatenate(contours), vertices, self._faces, view.rotation), ends[:-1])
        shown = [piece for line, kept in zip(contours, seen, strict=True) for piece in _pieces(line, kept)]
        smooth = [_smooth(view.project(line) / view.scale) for line in shown]
        curves = _Directed([line / view.scale for line in drawn])
        apart = [piece for line in smooth for piece in _pieces(line, ~curves.beside(line))]
        return [(line * view.scale).astype(np.float32) for line in apart if arc_length(line)[-1] >= _SHORTEST]


class _Directed:
    """Where lines (k, 2), in millimetres, run, and which way."""

    def __init__(self, lines: list[np.ndarray]) -> None:
        steps = np.concatenate([np.diff(line, axis=0) for line in lines])
        self._points = KDTree(np.concatenate([(line[1:] + line[:-1]) / 2 for line in lines]))
        self._directions = steps / np.maximum(np.linalg.norm(steps, axis=1, keepdims=True), 1e-9)

    def beside(self, line: np.ndarray) -> np.ndarray:
        """Which points of a line (n, 2) are near one of these lines and go the same way or back, (n,) bool."""
        distance, nearest = map(np.asarray, self._points.query(line, distance_upper_bound=_BESIDE))
        near = np.isfinite(distance)
        along = np.zeros(len(line))
        along[near] = np.abs((_directions(line)[near] * self._directions[nearest[near]]).sum(axis=1))
        return along > _ALONG


def region(template: Template, rest: np.ndarray) -> np.ndarray:
    """Where suggestive contours are wrinkles, (V,) bool: skin of the face off the lids, the lips and the nose.

    Parameters
    ----------
    template : Template
    rest : (V, 3) array
        A typical head at rest, millimetres.
    """
    size, view = int(CANVAS_MM * _PIXELS), View()
    curves = {name: rest[path] for name, path in template.curves.items()}

    def pixels(points: np.ndarray) -> np.ndarray:
        return np.rint(view.project(points) * size).astype(np.int32)

    def about(distance: float, *points: np.ndarray) -> np.ndarray:
        """Map (size, size) bool of what is no further from the convex hull of points than that."""
        outside = np.full((size, size), 255, dtype=np.uint8)
        cv2.fillConvexPoly(outside, cv2.convexHull(pixels(np.concatenate(points))), 0)
        return cv2.distanceTransform(outside, cv2.DIST_L2, 5) <= distance * _PIXELS

    inside = np.zeros((size, size), dtype=np.uint8)
    cv2.fillPoly(inside, [pixels(curves[SILHOUETTE])], 255)
    face = cv2.distanceTransform(inside, cv2.DIST_L2, 5) > _FROM_OUTLINE * _PIXELS
    for side in ("left", "right"):
        upper, lower = curves[f"{side}_eye_upper"], curves[f"{side}_eye_lower"]
        face &= ~about(0.0, curves[f"{side}_brow"], upper) & ~about(_FROM_EYES, upper, lower)
    face &= ~about(_FROM_LIPS, *(curves[name] for name in LIPS))
    face &= ~about(_FROM_NOSE, rest[template.landmarks[[_ROOT]]], curves["nose"])

    column, row = np.clip(pixels(rest), 0, size - 1).T
    front = np.asarray(igl.per_vertex_normals(rest.astype(np.float64), template.faces.astype(np.int64)))[:, 2] > 0
    return face[row, column] & front & (template.fine_parts == PARTS.index("skin"))


def _pieces(line: np.ndarray, kept: np.ndarray) -> list[np.ndarray]:
    """The pieces of a line (n, d) of which neighbouring points (n,) are kept."""
    pieces = np.split(np.arange(len(line)), np.flatnonzero(np.diff(kept)) + 1)
    return [line[piece] for piece in pieces if kept[piece[0]] and len(piece) > 1]


def _smooth(line: np.ndarray) -> np.ndarray:
    """A line (n, 2) in millimetres as a pen would draw it, in even steps."""
    even = resample(line, max(2, round(float(arc_length(line)[-1]) / _STEP) + 1))
    return gaussian_filter1d(even.astype(np.float64), _SMOOTHING, axis=0, mode="nearest")


def _directions(line: np.ndarray) -> np.ndarray:
    """Unit vectors (n, 2) along a line (n, 2)."""
    steps = np.gradient(line, axis=0)
    return steps / np.maximum(np.linalg.norm(steps, axis=1, keepdims=True), 1e-9)
