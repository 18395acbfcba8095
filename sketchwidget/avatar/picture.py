"""Pictures of a textured head without a graphics card."""

from __future__ import annotations

import cv2
import igl
import numpy as np

from ..geometry.rasterise import rasterise
from ..geometry.view import View

_OVERSAMPLING = 2
_LIGHT = np.array([-0.35, 0.45, 0.82])
_AMBIENT = 0.72  # the texture has the portrait's own light


def textured(
    vertices: np.ndarray, faces: np.ndarray, uv: np.ndarray, texture: np.ndarray, view: View, size: int
) -> np.ndarray:
    """A textured mesh as seen in a view, on white: (size, size, 3) uint8.

    Parameters
    ----------
    vertices : (V, 3) array
        Millimetres.
    faces : (F, 3) int array
    uv : (V, 2) array
        Between 0 and 1, v upwards.
    texture : (T, T, 3) uint8 array
    view : View
    size : int
        Pixels a side.
    """
    pixels = size * _OVERSAMPLING
    vertices, faces = np.asarray(vertices, dtype=np.float64), faces.astype(np.int64)
    triangle, weights = rasterise(view.project(vertices) * pixels, faces, (pixels, pixels), vertices @ view.rotation[2])
    drawn = triangle >= 0
    corners, share = faces[triangle[drawn]], weights[drawn][..., None]
    at = (uv[corners] * share).sum(axis=1)
    places = np.zeros((pixels, pixels, 2), dtype=np.float32)
    places[drawn] = at * (texture.shape[1], -texture.shape[0]) + (-0.5, texture.shape[0] - 0.5)
    x, y = cv2.split(places)
    colour = cv2.remap(texture, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE).astype(np.float32)
    normals = np.nan_to_num(np.asarray(igl.per_vertex_normals(vertices, faces))) @ view.rotation.T
    light = _AMBIENT + (1 - _AMBIENT) * np.clip(normals @ (_LIGHT / np.linalg.norm(_LIGHT)), 0, None)
    colour[drawn] *= (light[corners][..., None] * share).sum(axis=1)
    colour[~drawn] = 255
    small = cv2.resize(colour, (size, size), interpolation=cv2.INTER_AREA)
    return np.rint(np.clip(small, 0, 255)).astype(np.uint8)
