"""From the 468 points of MediaPipe's face mesh to the 68 of the iBUG scheme."""

from __future__ import annotations

import numpy as np

from ..sketch import resample

# Points of the mesh, the subject's right side first. The contour's are spread evenly over its oval, the brows' lie
# along their middle.
_OVAL = (127, 234, 93, 132, 58, 172, 136, 150, 149, 176, 148, 152)
_OVAL += (377, 400, 378, 379, 365, 397, 288, 361, 323, 454, 356)
_UPPER_BROWS = (70, 63, 105, 66, 107, 336, 296, 334, 293, 300)
_LOWER_BROWS = (46, 53, 52, 65, 55, 285, 295, 282, 283, 276)
_NOSE = (168, 197, 5, 1, 98, 97, 2, 326, 327)
_EYES = (33, 160, 158, 133, 153, 144, 362, 385, 387, 263, 373, 380)
_OUTER_LIPS = (61, 39, 37, 0, 267, 269, 291, 321, 405, 17, 181, 91)
_INNER_LIPS = (78, 81, 13, 311, 308, 402, 14, 178)
_INNER = np.array([*_NOSE, *_EYES, *_OUTER_LIPS, *_INNER_LIPS])

EYE_CORNERS = {"right": (33, 133), "left": (263, 362)}  # outer, inner


def ibug_68(mesh: np.ndarray) -> np.ndarray:
    """The 68 landmarks (68, 2) of a face mesh (468, 2)."""
    brows = (mesh[list(_UPPER_BROWS)] + mesh[list(_LOWER_BROWS)]) / 2
    return np.concatenate([resample(mesh[list(_OVAL)], 17), brows, mesh[_INNER]])
