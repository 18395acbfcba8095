"""Errors and differences as colours on heads (Figures 11 and 15 of the paper)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import cv2
import numpy as np

from ..face import PARTS, Face, FaceModel
from ..sketch import Sketch

_SIZE, _TITLE, _BAR = 200, 22, 14  # pixels: of a head, of the line of text over it, of the bar of colours
_VIEWS = ("front", "three-quarter")
_PLAIN = 0.82  # grey of what has no error: eyes, teeth, mouth


def skin_of(model: FaceModel) -> np.ndarray:
    """Which vertices (V,) bool errors are measured at."""
    return model.template.fine_parts == PARTS.index("skin")


def colours(distance: np.ndarray, most: float) -> np.ndarray:
    """Colours (n, 3), 0 to 1, of distances (n,): from blue at 0 to red at `most` and beyond."""
    levels = np.round(255 * np.clip(distance / most, 0.0, 1.0)).astype(np.uint8)
    return cv2.applyColorMap(levels[:, None], cv2.COLORMAP_TURBO)[:, 0, ::-1] / 255


def on_head(face: Face, distance: np.ndarray, most: float) -> np.ndarray:
    """A head seen from two sides (h, w, 3) uint8, the colour of its skin telling distances (s,)."""
    shown = np.full(face.vertices.shape, _PLAIN)
    shown[skin_of(face.model)] = colours(distance, most)
    return np.hstack([face.picture(view, _SIZE, shown) for view in _VIEWS])


def error_maps(model: FaceModel, errors: Mapping[str, np.ndarray], most: float = 6.0, columns: int = 3) -> np.ndarray:
    """The mean error at each place of the head, by method (h, w, 3) uint8 (Figure 15).

    Parameters
    ----------
    model : FaceModel
    errors : mapping of (s,) arrays
        Millimetres at each vertex of the skin, by method.
    most : float
        Millimetres that are shown in the last colour.
    columns : int
    """
    tiles = [
        _titled(f"{name}: {error.mean():.2f} mm", on_head(model.face(), error, most)) for name, error in errors.items()
    ]
    tiles += [np.full_like(tiles[0], 255)] * (-len(tiles) % columns)
    rows = [np.hstack(tiles[start : start + columns]) for start in range(0, len(tiles), columns)]
    return np.vstack([*rows, _bar(rows[0].shape[1], most)])


def wrinkle_maps(examples: Sequence[tuple[Sketch, Face, Face]], most: float = 3.0) -> np.ndarray:
    """What wrinkle lines change, face by face (h, w, 3) uint8 (Figure 11 c).

    Parameters
    ----------
    examples : sequence of (Sketch, Face, Face)
        A drawing with wrinkle lines, the head it gives, and the head that it gives without them.
    most : float
        Millimetres that are shown in the last colour.
    """
    rows = []
    for sketch, with_lines, without in examples:
        distance = np.linalg.norm(with_lines.vertices - without.vertices, axis=1)[skin_of(with_lines.model)]
        heads = [face.picture("front", _SIZE) for face in (with_lines, without)]
        title = f"sketch; head with and without wrinkle lines; difference {distance.mean():.2f} mm"
        rows.append(_titled(title, np.hstack([sketch.picture(_SIZE), *heads, on_head(with_lines, distance, most)])))
    return np.vstack([*rows, _bar(rows[0].shape[1], most)])


def _titled(title: str, picture: np.ndarray) -> np.ndarray:
    head = np.full((_TITLE, picture.shape[1], 3), 255, dtype=np.uint8)
    cv2.putText(head, title, (4, _TITLE - 7), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (40, 40, 40), 1, cv2.LINE_AA)
    return np.vstack([head, picture])


def _bar(width: int, most: float) -> np.ndarray:
    """The scale of colours, 0 to `most` mm."""
    ramp = np.round(255 * colours(np.linspace(0.0, most, width), most)).astype(np.uint8)
    return _titled(f"0 to {most:g} mm and more", np.repeat(ramp[None], _BAR, axis=0))
