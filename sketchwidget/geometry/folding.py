"""Triangles that an edit of a surface turned over."""

from __future__ import annotations

import numpy as np

_FACING = 0.5  # cosine of the angle to the viewer: what is seen more edge-on does not tell


def turned_over(before: np.ndarray, after: np.ndarray, triangles: np.ndarray) -> int:
    """How many triangles that faced the front face the back.

    What overhangs before is no fold.

    Parameters
    ----------
    before, after : (v, 3) arrays
        Vertices; the front is where z points to.
    triangles : (t, 3) int array
    """
    one, other = (before[triangles[:, corner]] - before[triangles[:, 0]] for corner in (1, 2))
    normal = np.cross(one, other)
    faced = triangles[normal[:, 2] > _FACING * np.linalg.norm(normal, axis=1)]
    (a, b), (c, d) = ((after[faced[:, corner], :2] - after[faced[:, 0], :2]).T for corner in (1, 2))
    return int((a * d < b * c).sum())
