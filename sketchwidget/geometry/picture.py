"""Shaded pictures of a mesh without a graphics card: for documents, notebooks and tests."""

from __future__ import annotations

import cv2
import igl
import numpy as np

from .view import View

# Directional lights in the viewer's frame and their strength: a key from the upper left, a weak fill, a rim from
# behind.
_LIGHTS = np.array([[-0.5, 0.6, 0.75], [0.8, 0.1, 0.5], [0.3, 0.5, -0.9]])
_STRENGTHS = np.array([0.75, 0.22, 0.25])
_AMBIENT = 0.22
_OVERSAMPLING = 3


def picture(
    vertices: np.ndarray,
    faces: np.ndarray,
    colors: np.ndarray,
    view: View | None = None,
    size: int = 320,
    background: float = 1.0,
) -> np.ndarray:
    """A mesh as seen in a view: triangles painted from back to front, each lit by its corners' normals.

    Parameters
    ----------
    vertices : (n, 3) array
        Millimetres.
    faces : (m, 3) int array
    colors : (n, 3) array
        Between 0 and 1.
    view : View, optional
        The front by default; the canvas is the picture.
    size : int
        Pixels a side.
    background : float
        Grey level between 0 and 1.

    Returns
    -------
    (size, size, 3) uint8 array

    Raises
    ------
    ValueError
        If the size is not between 1 and 4,096.
    """
    if not 1 <= size <= 4096:
        raise ValueError(f"a picture has 1 to 4,096 pixels a side; given {size}")
    view = view or View()
    normals = igl.per_vertex_normals(np.asarray(vertices, dtype=np.float64), np.asarray(faces, dtype=np.int64))
    normals = np.nan_to_num(normals) @ view.rotation.T
    lights = _LIGHTS / np.linalg.norm(_LIGHTS, axis=1, keepdims=True)
    light = _AMBIENT + np.clip(normals @ lights.T, 0, None) @ _STRENGTHS
    shade = (np.clip(colors * light[:, None], 0, 1) * 255)[faces].mean(axis=1)

    depth = (np.asarray(vertices) @ view.rotation[2])[faces].mean(axis=1)
    pixels = size * _OVERSAMPLING
    corners = np.round(view.project(vertices) * pixels * 16).astype(np.int32)[faces]  # 4 fractional bits
    edge, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    facing = edge[:, 0].astype(np.int64) * other[:, 1] - edge[:, 1].astype(np.int64) * other[:, 0] < 0
    order = np.flatnonzero(facing)[np.argsort(depth[facing], kind="stable")]

    canvas = np.full((pixels, pixels, 3), background * 255, dtype=np.uint8)
    for triangle, color in zip(corners[order], shade[order].tolist(), strict=True):
        cv2.fillConvexPoly(canvas, triangle, color, lineType=cv2.LINE_8, shift=4)
    return cv2.resize(canvas, (size, size), interpolation=cv2.INTER_AREA)
