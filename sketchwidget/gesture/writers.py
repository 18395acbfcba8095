"""Simulated writers: how people would draw the gestures, made up, since nobody's recordings are published.

A writer is a set of habits; each gesture of theirs strays from these a little. What is drawn by writers that training
has not met tells how well gestures are told apart by the manner in which *these* writers draw; people may differ.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ..sketch import resample
from . import shapes
from .names import ARROWS, DOWN_ROLLS, GESTURES, LEFT_ARROW, LINE, REGION, UP_ROLLS

_DENSE = 200  # points at which a path is bent and smoothed


@dataclass(frozen=True)
class Writer:
    """The habits of a writer, and how they draw.

    Parameters
    ----------
    size : float
        Of a gesture's longer side, in canvas units.
    speed : float
        Points from one end of a gesture to the other, the fewer the faster: 20 to 200.
    slant : float
        Shear to the right, as a share of the height.
    tilt : float
        Of the base line, radians.
    aspect : float
        Width over height, times that of the plain shape.
    tremor : float
        Standard deviation of what the hand adds, as a share of the size.
    roundness : float
        How far corners are cut, as a share of the path's length.
    overshoot : float
        Length of the hooks at which the pen comes down and goes up, as a share of the size.
    closure : float
        How far the ends of a loop overlap, in turns; they miss each other if it is negative.
    unevenness : float
        Spread of the logarithms of sizes that should be equal: loops, barbs.
    width : float
        Of loops, as a share of their height.
    advance : float
        From loop to loop, as a share of their width.
    start : float
        Where loops that enclose are begun, in turns.
    shaft : float
        Chance that an arrow has one.
    reversed : float
        Chance that a stroke is drawn from its other end, or the other way round.
    """

    size: float = 0.3
    speed: float = 60.0
    slant: float = 0.0
    tilt: float = 0.0
    aspect: float = 1.0
    tremor: float = 0.005
    roundness: float = 0.01
    overshoot: float = 0.0
    closure: float = 0.0
    unevenness: float = 0.1
    width: float = 0.6
    advance: float = 0.9
    start: float = 0.75
    shaft: float = 0.7
    reversed: float = 0.2

    @classmethod
    def random(cls, seed: int) -> Writer:
        """A writer of whom the same number always makes the same."""
        random = np.random.default_rng([seed, 2017])
        return cls(
            size=random.uniform(0.08, 0.6),
            speed=random.uniform(20, 140),
            slant=random.normal(0.1, 0.2),
            tilt=random.normal(0.0, 0.1),
            aspect=np.exp(random.normal(0.0, 0.2)),
            tremor=np.exp(random.normal(-5.2, 0.6)),
            roundness=random.uniform(0.0, 0.018),
            overshoot=random.exponential(0.015),
            closure=random.normal(0.01, 0.03),
            unevenness=random.uniform(0.03, 0.25),
            width=random.uniform(0.4, 1.2),
            advance=random.uniform(0.35, 1.3),
            start=random.uniform(0, 1),
            shaft=random.choice([0.0, 0.3, 0.8, 1.0]),
            reversed=random.choice([0.0, 0.2, 0.5, 1.0]),
        )

    def draw(self, name: str, random: np.random.Generator) -> np.ndarray:
        """A gesture as this writer draws it now.

        Parameters
        ----------
        name : str
            One of `GESTURES`.
        random : numpy Generator

        Returns
        -------
        (n, 2) float32 array
            Canvas points.

        Raises
        ------
        ValueError
            If there is no such gesture.
        """
        if name not in GESTURES:
            raise ValueError(f"a gesture is one of {', '.join(GESTURES)}; given {name!r}")
        if name == LINE:
            return self._line(random)
        if name == REGION:
            return self._region(random)
        if name in ARROWS:
            return self._arrow(-1.0 if name == LEFT_ARROW else 1.0, random)
        upwards = name in UP_ROLLS
        loops = 1 + (UP_ROLLS if upwards else DOWN_ROLLS).index(name)
        return self.write(self._roll(loops, random) * [1.0, 1.0 if upwards else -1.0], random)

    def write(self, path: np.ndarray, random: np.random.Generator, upright: bool = True) -> np.ndarray:
        """A path (n, 2) of any size as this writer's hand follows it: canvas points (m, 2) float32.

        Parameters
        ----------
        path : (n, 2) array
        random : numpy Generator
        upright : bool
            Whether it has a base line, which is slanted, tilted and stretched as the writer does.
        """
        if upright:
            path = path * [self.aspect * np.exp(random.normal(0.0, 0.08)), 1.0]
            path = path - (self.slant + random.normal(0.0, 0.06)) * path[:, 1:] * [1.0, 0.0]
            path = shapes.turned(path, self.tilt + random.normal(0.0, 0.05))
        path = resample(path, _DENSE).astype(np.float64)
        extent = float(np.ptp(path, axis=0).max())
        path *= self.size * np.exp(random.normal(0.0, 0.15)) / extent
        size = float(np.ptp(path, axis=0).max())
        path = gaussian_filter1d(path, 1e-3 + self.roundness * _DENSE, axis=0, mode="nearest")
        path += size * self._bends(random)
        path = self._with_hooks(path, size, random)
        points = max(8, round(self.speed * np.exp(random.normal(0.0, 0.2))))
        path = resample(path, points) + random.normal(0.0, 0.25 * self.tremor * size, (points, 2))
        room = np.maximum(0.0, 1.0 - np.ptp(path, axis=0))
        return (path - path.min(axis=0) + room * random.uniform(0, 1, 2)).astype(np.float32)

    def _line(self, random: np.random.Generator) -> np.ndarray:
        sag = np.clip(random.normal(0.0, 0.06), -0.2, 0.2)
        return self.write(shapes.line(random.uniform(0, 2 * np.pi), sag), random, upright=False)

    def _region(self, random: np.random.Generator) -> np.ndarray:
        bumps = random.normal(0.0, 1.0, 6) * np.repeat([0.1, 0.05, 0.03], 2)
        extent = 1.0 + np.clip(self.closure + random.normal(0.0, 0.02), -0.08, 0.12)
        path = shapes.region(np.exp(random.uniform(-1.0, 0.0)), bumps, self.start + random.normal(0.0, 0.08), extent)
        path *= 1.0 + np.linspace(0.0, random.normal(0.0, 0.05), len(path))[:, None]  # ends that pass each other
        path = shapes.turned(path, random.uniform(0, np.pi))
        return self.write(self._maybe_reversed(path, random), random, upright=False)

    def _arrow(self, side: float, random: np.random.Generator) -> np.ndarray:
        has_shaft = random.random() < self.shaft
        long = random.uniform(0.22, 0.65) if has_shaft else 1.0
        spread = self.unevenness * random.normal(0.0, 1.0, 2)
        angles = random.uniform(0.4, 0.95) * np.exp(0.5 * self.unevenness * random.normal(0.0, 1.0, 2))
        first, second = long * np.exp(spread)
        path = shapes.arrow(float(has_shaft), (first, second), tuple(angles), random.random() < 0.15)
        path = path * [side, random.choice([-1.0, 1.0])]
        return self.write(path, random)

    def _roll(self, loops: int, random: np.random.Generator) -> np.ndarray:
        uneven = np.exp(self.unevenness * random.normal(0.0, 1.0, (2, loops)))
        width = self.width * np.exp(random.normal(0.0, 0.1))
        # Past this width a loop no longer closes; below it, one alone is a region, and many are rings.
        advance = width * np.clip(self.advance * np.exp(random.normal(0.0, 0.1)), 0.3 if loops > 1 else 0.45, 1.5)
        flat = random.exponential(0.15) if random.random() < 0.3 else 0.0
        # With no lead, loops above are one loop less below, whose leads are half a turn.
        lead = random.uniform(0.04 if loops > 1 else 0.12, 0.4, 2)
        path = shapes.roll(loops, uneven[0], width * uneven[1], advance, flat, tuple(lead))
        tails = random.exponential(0.25, 2) * (random.random(2) < 0.4)
        start, end = path[:1] - np.array([tails[0], 0.0]), path[-1:] + np.array([tails[1], 0.0])
        path = np.concatenate([start, path, end])
        path = path * [random.choice([-1.0, 1.0]), 1.0] if random.random() < self.reversed else path
        return self._maybe_reversed(path, random)

    def _maybe_reversed(self, path: np.ndarray, random: np.random.Generator) -> np.ndarray:
        return path[::-1] if random.random() < self.reversed else path

    def _bends(self, random: np.random.Generator) -> np.ndarray:
        """What an unsteady hand adds to a path, (200, 2), as a share of its size: bends of a few lengths."""
        total = np.zeros((_DENSE, 2))
        for knots in (4, 9, 20):
            places = np.linspace(0, knots - 1, _DENSE)
            bends = random.normal(0.0, self.tremor * np.sqrt(9 / knots), (2, knots))
            total += np.stack([np.interp(places, np.arange(knots), bend) for bend in bends], axis=1)
        return gaussian_filter1d(total, 3.0, axis=0, mode="nearest")

    def _with_hooks(self, path: np.ndarray, size: float, random: np.random.Generator) -> np.ndarray:
        ends = []
        for end, before in ((path[0], path[6]), (path[-1], path[-7])):
            along = (end - before) / max(float(np.hypot(*(end - before))), 1e-9)
            hook = shapes.turned(along[None], random.normal(0.0, 1.2))[0]
            ends.append(end + hook * size * min(random.exponential(self.overshoot), 0.07))
        return np.concatenate([ends[:1], path, ends[1:]])
