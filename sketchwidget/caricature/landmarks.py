"""Landmarks of a picture, checked before anything is fitted to them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..geometry.camera import Camera

COUNT = 68
FEWEST = 8  # that count: a camera has six numbers, and a face is more than a camera

_THINNEST = 0.02  # of the longer side: below, landmarks lie on a line


def as_landmarks(landmarks: Any, weights: np.ndarray) -> np.ndarray:
    """Landmarks (68, 2) float64 in pixels; one of weight 0 may be anything.

    Raises
    ------
    ValueError
        If they are not 68 pairs of numbers, or one that counts is not finite.
    """
    try:
        given = np.array(landmarks, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"landmarks are {COUNT} pairs (x, y) of pixels: {error}") from error
    if given.shape != (COUNT, 2):
        raise ValueError(f"landmarks are {COUNT} pairs (x, y) of pixels in iBUG order; given shape {given.shape}")
    wrong = np.flatnonzero(~np.isfinite(given).all(axis=1) & (weights > 0))
    if len(wrong):
        raise ValueError(f"landmarks are finite; not so those numbered {', '.join(map(str, wrong))}")
    return given


def as_weights(weights: Any) -> np.ndarray:
    """Weights (68,) float64 of landmarks; None is 1 for each.

    Raises
    ------
    ValueError
        If they are not 68 finite numbers of at least 0, or fewer than 8 landmarks count.
    """
    try:
        given = np.ones(COUNT) if weights is None else np.asarray(weights, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"the weights of landmarks are {COUNT} finite numbers of at least 0: {error}") from error
    if given.shape != (COUNT,) or not np.isfinite(given).all() or (given < 0).any():
        raise ValueError(f"the weights of landmarks are {COUNT} finite numbers of at least 0; given {weights!r}")
    if (given > 0).sum() < FEWEST:
        raise ValueError(f"a fit takes at least {FEWEST} landmarks; only {(given > 0).sum()} have a weight above 0")
    return given


def check_spread(landmarks: np.ndarray) -> None:
    """Refuse landmarks (n, 2) that lie in a point or on a line (ValueError)."""
    centred = landmarks - landmarks.mean(axis=0)
    longer, shorter = np.linalg.svd(centred, compute_uv=False)
    places = len(np.unique(landmarks.round(6), axis=0))
    if places == 1:
        where = "in one point"
    elif shorter <= _THINNEST * longer:
        where = "on a line"
    elif places < FEWEST:
        where = f"in {places} places"
    else:
        return
    raise ValueError(f"landmarks are spread over a face; given {len(landmarks)} that lie {where}")


def check_orientation(camera: Camera) -> None:
    """Refuse landmarks that show a face from behind or on its head, and say how they came about (ValueError).

    A mirror image of a face is projected by a camera behind it.
    """
    right, up, towards = np.diag(camera.rotation)
    if towards < 0 and right < up:
        raise ValueError(
            "the landmarks are a mirror image: in iBUG order the first ones are on the subject's right, at the left of"
            " the picture"
        )
    if towards < 0:
        raise ValueError("the landmarks are upside down: y goes down in a picture, so that the chin has the greatest y")
    if up < 0:
        raise ValueError("the face stands on its head: turn the picture and its landmarks by 180 degrees")
