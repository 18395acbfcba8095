"""Moving least squares: the plane deformed by points that move (Schaefer, McPhail and Warren 2006)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

# From a point's arm (n, 2) from the weighted centre of the controls, the controls' arms before and after (n, k, 2) and
# their weights (n, k) to the point's new arm.
_Motion = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]

_FALLOFF = 2.0  # the paper's alpha: weights fall with distance to the power of twice this; smooth at the controls too
_NEAR = 1e-6  # of the controls' extent: a point this near to a control moves with it
_FLAT = 1e-6  # breadth over length of controls that count as points of one line


def affine(points: np.ndarray, controls: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Points carried along by control points, each by the affine map that fits the controls near it best.

    Parameters
    ----------
    points : (n, 2) array
    controls : (k, 2) array
        Not all on one line.
    moved : (k, 2) array
        Where the controls go.

    Returns
    -------
    (n, 2) array
        A control goes exactly where it was moved; if all moved by one affine map, so does every point.

    Raises
    ------
    ValueError
        If `moved` has another shape than `controls`, or the controls are all on one line.

    References
    ----------
    Schaefer, McPhail and Warren, "Image deformation using moving least squares", 2006, section 2.1.
    """
    controls, moved = _checked(controls, moved)
    sizes = np.linalg.svd(controls - controls.mean(axis=0), compute_uv=False)
    if len(controls) < 3 or sizes[1] <= _FLAT * sizes[0]:
        raise ValueError("an affine deformation takes controls that are not all on one line")

    def move(arm: np.ndarray, arms: np.ndarray, moved_arms: np.ndarray, weights: np.ndarray) -> np.ndarray:
        weighted = np.swapaxes(arms * weights[..., None], 1, 2)
        return (arm[:, None] @ np.linalg.solve(weighted @ arms, weighted @ moved_arms))[:, 0]

    return _deform(points, controls, moved, move)


def similarity(points: np.ndarray, controls: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Points carried along by control points, each by the turn, scale and shift that fits the controls near it best.

    Parameters
    ----------
    points : (n, 2) array
    controls : (k, 2) or (n, k, 2) array
        Of all points, or of each of them; at least two of them apart.
    moved : array of the same shape
        Where the controls go.

    Returns
    -------
    (n, 2) array
        A control goes exactly where it was moved; if all moved by one similarity, so does every point.

    Raises
    ------
    ValueError
        If `moved` has another shape than `controls`, or the controls are all in one place.

    References
    ----------
    Schaefer, McPhail and Warren, "Image deformation using moving least squares", 2006, section 2.2.
    """
    controls, moved = _checked(controls, moved)
    if not np.ptp(controls, axis=-2).any(axis=-1).all():
        raise ValueError("a deformation by similarities takes controls in at least two places")

    def move(arm: np.ndarray, arms: np.ndarray, moved_arms: np.ndarray, weights: np.ndarray) -> np.ndarray:
        start, end, own = (_complex(values) for values in (arms, moved_arms, arm))
        turn = (weights * start.conj() * end).sum(axis=1) / (weights * np.abs(start) ** 2).sum(axis=1)
        return np.stack([(own * turn).real, (own * turn).imag], axis=1)

    return _deform(points, controls, moved, move)


def _checked(controls: np.ndarray, moved: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    controls, moved = np.asarray(controls, dtype=np.float64), np.asarray(moved, dtype=np.float64)
    if controls.ndim < 2 or controls.shape[-1] != 2 or controls.shape != moved.shape or not controls.shape[-2]:
        raise ValueError(f"controls (k, 2) move to as many places; given shapes {controls.shape} and {moved.shape}")
    return controls, moved


def _deform(points: np.ndarray, controls: np.ndarray, moved: np.ndarray, move: _Motion) -> np.ndarray:
    points = np.asarray(points, dtype=np.float64)
    each = (len(points), *controls.shape[-2:])
    controls, moved = np.broadcast_to(controls, each), np.broadcast_to(moved, each)
    distance = np.linalg.norm(points[:, None] - controls, axis=2)
    closest = np.arange(len(points)), distance.argmin(axis=1)
    gap = distance[closest]
    deformed = points + (moved - controls)[closest]
    far = np.flatnonzero(gap > _NEAR * np.ptp(controls, axis=1).max(axis=1))
    controls, moved = controls[far], moved[far]
    weights = (gap[far, None] / distance[far]) ** (2 * _FALLOFF)
    weights /= weights.sum(axis=1, keepdims=True)
    centre, moved_centre = ((weights[:, None] @ ends)[:, 0] for ends in (controls, moved))
    arms, moved_arms = controls - centre[:, None], moved - moved_centre[:, None]
    deformed[far] = move(points[far] - centre, arms, moved_arms, weights) + moved_centre
    return deformed


def _complex(points: np.ndarray) -> np.ndarray:
    return points[..., 0] + 1j * points[..., 1]
