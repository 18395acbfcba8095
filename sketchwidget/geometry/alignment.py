"""Similarity alignment of point sets."""

from __future__ import annotations

import numpy as np


def similarity(points: np.ndarray, target: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Scale, rotation and translation that bring points closest to a target in least squares.

    Parameters
    ----------
    points, target : (n, 3) arrays
        Corresponding points, not all equal.

    Returns
    -------
    scale : float
    rotation : (3, 3) array
    translation : (3,) array
        ``scale * points @ rotation.T + translation`` is nearest to ``target``.

    Raises
    ------
    ValueError
        If they are no two arrays of one shape.

    References
    ----------
    Umeyama, "Least-squares estimation of transformation parameters between two point patterns", 1991.
    """
    points, target = np.asarray(points, dtype=np.float64), np.asarray(target, dtype=np.float64)
    if points.shape != target.shape or points.ndim != 2:
        raise ValueError(f"alignment takes two arrays of one shape (n, 3); given {points.shape} and {target.shape}")
    centre, target_centre = points.mean(axis=0), target.mean(axis=0)
    centred, target_centred = points - centre, target - target_centre
    left, singular, right = np.linalg.svd(target_centred.T @ centred)
    proper = np.ones(len(singular))
    proper[-1] = np.sign(np.linalg.det(left @ right))
    rotation = left @ np.diag(proper) @ right
    scale = float((singular * proper).sum() / (centred**2).sum())
    return scale, rotation, target_centre - scale * rotation @ centre
