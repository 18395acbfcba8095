"""Lines as an unsteady hand draws them: random smooth deformation, after Yu et al., "Sketch me that shoe", 2016."""

from __future__ import annotations

import numpy as np

from .polyline import arc_length, resample

_POINTS_PER_UNIT = 90  # of canvas length; close enough that no corner shows
_FEWEST, _MOST = 6, 90


def wobble(points: np.ndarray, amount: float, random: np.random.Generator) -> np.ndarray:
    """A line bent by smooth noise.

    Parameters
    ----------
    points : (n, 2) array
    amount : float
        Standard deviation of the displacement, in the unit of the points.
    random : numpy Generator

    Returns
    -------
    (m, 2) array
        Evenly spaced.
    """
    length = float(arc_length(points)[-1])
    if length == 0.0:
        return points + random.normal(0.0, amount, 2)
    count = int(np.clip(length * _POINTS_PER_UNIT, _FEWEST, _MOST))
    knots = int(random.integers(3, 8))
    bends = random.normal(0.0, amount, (2, knots))
    along = np.linspace(0.0, knots - 1.0, count)
    noise = np.stack([np.interp(along, np.arange(knots), _rounded(bend)) for bend in bends], axis=1)
    return resample(points, count) + noise


def trim(points: np.ndarray, most: float, random: np.random.Generator) -> np.ndarray:
    """A line that starts late and ends early, each by up to a share `most` of its points."""
    start, end = (random.uniform(0, most, 2) * len(points)).astype(int)
    return points[start : max(len(points) - end, start + 2)]


def misplace(lines: list[np.ndarray], shift: float, stretch: float, random: np.random.Generator) -> list[np.ndarray]:
    """Lines moved and stretched together about their middle.

    Parameters
    ----------
    lines : list of (n, 2) arrays
    shift : float
        Standard deviation of the move, in the unit of the points.
    stretch : float
        Standard deviation of each axis's scale about 1.
    random : numpy Generator
    """
    everything = np.concatenate(lines)
    middle = (everything.min(axis=0) + everything.max(axis=0)) / 2
    scale = np.exp(random.normal(0, stretch, 2))
    target = middle + random.normal(0, shift, 2)
    return [(line - middle) * scale + target for line in lines]


def _rounded(values: np.ndarray) -> np.ndarray:
    """Values with their steps softened, so that linear interpolation between them bends gently."""
    padded = np.concatenate([values[:1], values, values[-1:]])
    return 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:]
