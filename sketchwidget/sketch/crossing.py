"""Where polylines cross."""

from __future__ import annotations

import numpy as np
from skimage.measure import points_in_poly


def cross(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two polylines (n, 2) and (m, 2) cross."""
    apart = (one.min(axis=0) > other.max(axis=0)) | (other.min(axis=0) > one.max(axis=0))
    return not apart.any() and bool(_crossings(one, other)[0].any())


def swept(former: np.ndarray, new: np.ndarray, other: np.ndarray) -> bool:
    """Whether a polyline that goes from a former place (n, 2) to a new one (m, 2) passes over another line (k, 2).

    A point of the other line that lies between the two is passed over, and so is a line that is crossed at last.
    """
    between = points_in_poly(other, np.concatenate([former, new[::-1]])).any()
    return bool(between) or (cross(new, other) and not cross(former, other))


def without_loops(line: np.ndarray) -> np.ndarray:
    """A polyline (n, 2) without the loops between the places where it crosses itself.

    From its beginning on, each loop is left out as a whole: the way goes straight on where it first crosses itself.
    """
    kept: list[np.ndarray] = []
    while len(line) > 3:
        meets, share = _crossings(line, line)
        meets &= np.arange(len(meets))[None, :] > np.arange(len(meets))[:, None] + 1
        if not meets.any():
            break
        first = int(np.argmax(meets.any(axis=1)))
        last = int(np.flatnonzero(meets[first])[-1])
        crossing = line[first] + share[first, last] * (line[first + 1] - line[first])
        kept.append(line[: first + 1])
        line = np.concatenate([[crossing], line[last + 1 :]])
    return np.concatenate([*kept, line])


def _crossings(one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which edges cross, (n - 1, m - 1) bool, and where on the edge of the first."""
    a, b = one[:-1, None].astype(np.float64), one[1:, None].astype(np.float64)
    c, d = other[None, :-1].astype(np.float64), other[None, 1:].astype(np.float64)
    sides = _turn(a, b, c), _turn(a, b, d)
    others = _turn(c, d, a), _turn(c, d, b)
    meets = (sides[0] * sides[1] < 0) & (others[0] * others[1] < 0)
    difference = others[0] - others[1]
    return meets, others[0] / np.where(difference == 0, 1.0, difference)


def _turn(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Twice the signed area of triangles."""
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
