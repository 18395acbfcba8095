"""Strokes that are none of the gestures: letters, digits, signs and scribbles, for a classifier to refuse."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ..sketch import resample
from . import shapes
from .writers import Writer

# Each in one stroke, on a grid of 4 x 6 with y down. The second entry tells whether it is round. Letters whose shape is
# a gesture's (o, l, e, D, <, >) are not among them.
_GLYPHS: dict[str, tuple[list[tuple[float, float]], bool]] = {
    "a": ([(4, 3), (2, 2), (0, 4), (1, 6), (3, 5), (4, 3), (4, 5), (5, 6)], True),
    "b": ([(0, 0), (0, 6), (0, 4), (2, 3), (4, 4), (3, 6), (0, 6)], True),
    "c": ([(4, 3), (2, 2), (0, 4), (2, 6), (4, 5)], True),
    "d": ([(4, 3), (2, 2), (0, 4), (1, 6), (4, 4), (4, 0), (4, 6)], True),
    "f": ([(4, 1), (3, 0), (2, 1), (2, 6), (2, 3), (0, 3), (4, 3)], True),
    "g": ([(4, 2), (2, 1), (0, 3), (2, 4), (4, 2), (4, 6), (2, 7), (0, 6)], True),
    "h": ([(0, 0), (0, 6), (0, 4), (2, 3), (4, 4), (4, 6)], True),
    "k": ([(0, 0), (0, 6), (0, 4), (3, 2), (0, 4), (4, 6)], False),
    "m": ([(0, 3), (0, 6), (0, 4), (1, 3), (2, 4), (2, 6), (2, 4), (3, 3), (4, 4), (4, 6)], True),
    "n": ([(0, 3), (0, 6), (0, 4), (2, 3), (4, 4), (4, 6)], True),
    "p": ([(0, 2), (0, 7), (0, 3), (2, 2), (4, 3), (3, 5), (0, 5)], True),
    "q": ([(4, 3), (2, 2), (0, 3), (1, 5), (4, 4), (4, 7)], True),
    "r": ([(0, 3), (0, 6), (0, 4), (2, 3), (4, 3)], True),
    "s": ([(4, 1), (2, 0), (0, 1), (2, 3), (4, 5), (2, 6), (0, 5)], True),
    "t": ([(2, 0), (2, 5), (3, 6), (2, 5), (2, 2), (0, 2), (4, 2)], False),
    "u": ([(0, 2), (0, 5), (2, 6), (4, 5), (4, 2), (4, 6)], True),
    "y": ([(0, 2), (1, 4), (3, 4), (4, 2), (4, 6), (2, 7), (0, 6)], True),
    "z": ([(0, 2), (4, 2), (0, 6), (4, 6)], False),
    "A": ([(0, 6), (2, 0), (4, 6), (3, 4), (1, 4)], False),
    "B": ([(0, 6), (0, 0), (3, 0), (3, 3), (0, 3), (4, 4), (3, 6), (0, 6)], True),
    "E": ([(4, 0), (0, 0), (0, 3), (3, 3), (0, 3), (0, 6), (4, 6)], False),
    "F": ([(4, 0), (0, 0), (0, 6), (0, 3), (3, 3)], False),
    "G": ([(4, 1), (2, 0), (0, 3), (2, 6), (4, 4), (2, 4)], True),
    "H": ([(0, 0), (0, 6), (0, 3), (4, 3), (4, 0), (4, 6)], False),
    "J": ([(4, 0), (4, 5), (2, 6), (0, 5)], True),
    "L": ([(0, 0), (0, 6), (4, 6)], False),
    "M": ([(0, 6), (0, 0), (2, 4), (4, 0), (4, 6)], False),
    "N": ([(0, 6), (0, 0), (4, 6), (4, 0)], False),
    "P": ([(0, 6), (0, 0), (3, 0), (4, 2), (3, 3), (0, 3)], True),
    "R": ([(0, 6), (0, 0), (3, 0), (4, 2), (3, 3), (0, 3), (4, 6)], True),
    "T": ([(0, 0), (4, 0), (2, 0), (2, 6)], False),
    "U": ([(0, 0), (0, 4), (2, 6), (4, 4), (4, 0)], True),
    "V": ([(0, 0), (2, 6), (4, 0)], False),
    "W": ([(0, 0), (1, 6), (2, 2), (3, 6), (4, 0)], False),
    "X": ([(0, 0), (4, 6), (2, 3), (4, 0), (0, 6)], False),
    "Y": ([(0, 0), (2, 3), (4, 0), (2, 3), (2, 6)], False),
    "Z": ([(0, 0), (4, 0), (0, 6), (4, 6)], False),
    "2": ([(0, 1), (2, 0), (4, 2), (0, 6), (4, 6)], False),
    "3": ([(0, 0), (3, 0), (4, 2), (2, 3), (4, 4), (3, 6), (0, 6)], True),
    "4": ([(3, 6), (3, 0), (0, 4), (4, 4)], False),
    "5": ([(4, 0), (0, 0), (0, 3), (3, 2), (4, 4), (3, 6), (0, 6)], False),
    "6": ([(4, 0), (1, 2), (0, 4), (2, 6), (4, 5), (2, 3), (0, 4)], True),
    "7": ([(0, 0), (4, 0), (1, 6)], False),
    "8": ([(4, 1), (2, 0), (0, 1), (2, 3), (4, 5), (2, 6), (0, 5), (2, 3), (4, 1)], True),
    "9": ([(4, 2), (2, 3), (0, 2), (2, 0), (4, 2), (4, 4), (3, 6)], True),
    "?": ([(0, 1), (2, 0), (4, 1), (2, 3), (2, 6)], True),
    "check": ([(0, 4), (1, 6), (4, 0)], False),
    "star": ([(0, 6), (2, 0), (4, 6), (0, 2), (4, 2), (0, 6)], False),
    "cross": ([(2, 0), (2, 6), (2, 3), (0, 3), (4, 3)], False),
    "lambda": ([(0, 6), (2, 3), (1, 0), (4, 6)], False),
}


def other(writer: Writer, random: np.random.Generator) -> np.ndarray:
    """A stroke (n, 2) float32 of a writer that is no gesture, canvas points."""
    kinds, weights = zip(*_KINDS.items(), strict=True)
    kind = kinds[random.choice(len(kinds), p=np.array(weights) / sum(weights))]
    return writer.write(kind(random), random)


def _glyph(random: np.random.Generator) -> np.ndarray:
    corners, round_ = list(_GLYPHS.values())[random.integers(len(_GLYPHS))]
    path = np.array(corners, dtype=np.float64) + random.normal(0.0, random.uniform(0.1, 0.4), (len(corners), 2))
    path = path * [random.uniform(0.6, 1.3), 1.0]
    return _smooth(path, random.uniform(0.02, 0.07)) if round_ or random.random() < 0.2 else path


def _scribble(random: np.random.Generator) -> np.ndarray:
    """A closed or an open tangle of several turns."""
    places = np.linspace(0.0, random.uniform(0.8, 1.0), 200) * 2 * np.pi
    path = np.zeros((200, 2))
    for harmonic in range(1, random.integers(4, 8)):
        waves = np.stack([np.cos(harmonic * places), np.sin(harmonic * places)], axis=1)
        path += waves @ random.normal(0.0, 1.0 if harmonic > 1 else 0.5, (2, 2)) / harmonic**0.3
    return path


def _zigzag(random: np.random.Generator) -> np.ndarray:
    count = random.integers(4, 12)
    path = np.stack([np.arange(count) * random.uniform(0.2, 1.0), np.arange(count) % 2], axis=1)
    return shapes.turned(path + random.normal(0.0, 0.08, path.shape), random.uniform(0, np.pi))


def _wave(random: np.random.Generator) -> np.ndarray:
    t = np.linspace(0.0, random.uniform(0.7, 4.0), 150) + random.uniform(0.0, 1.0)
    path = np.stack([t * random.uniform(0.6, 1.5), random.uniform(0.15, 0.6) * np.sin(2 * np.pi * t)], axis=1)
    return shapes.turned(path, random.uniform(0, 2 * np.pi))


def _arc(random: np.random.Generator) -> np.ndarray:
    turn = np.linspace(0.0, random.uniform(0.32, 0.8), 80) * 2 * np.pi
    path = np.stack([np.cos(turn), random.uniform(0.5, 1.0) * np.sin(turn)], axis=1)
    return shapes.turned(path, random.uniform(0, 2 * np.pi))


def _coil(random: np.random.Generator) -> np.ndarray:
    """A spiral, or rings about one place."""
    turns = random.uniform(1.3, 5.0)
    turn = np.linspace(0.0, turns, 240) * 2 * np.pi
    # Little more than a turn that stays as far out is a region whose ends overlap.
    radius = np.linspace(random.uniform(0.0, 1.0 if turns > 1.6 else 0.6), 1.0, 240)
    path = radius[:, None] * np.stack([np.cos(turn), random.uniform(0.5, 1.0) * np.sin(turn)], axis=1)
    return shapes.turned(path * [random.choice([-1, 1]), 1], random.uniform(0, 2 * np.pi))


def _slanting_arrow(random: np.random.Generator) -> np.ndarray:
    """An arrow or a chevron that points to neither side."""
    angles = tuple(random.uniform(0.35, 0.95, 2))
    path = shapes.arrow(float(random.random() < 0.5), tuple(random.uniform(0.3, 0.7, 2)), angles)
    return shapes.turned(path, random.choice([-1, 1]) * np.pi * random.uniform(0.28, 0.72))


def _many_headed_arrow(random: np.random.Generator) -> np.ndarray:
    """An arrow to both sides, or chevrons one after the other."""
    barbs, angles = tuple(random.uniform(0.2, 0.6, 2)), tuple(random.uniform(0.4, 0.95, 2))
    head = shapes.arrow(0.0, barbs, angles)
    if random.random() < 0.6:
        other_head = shapes.arrow(0.0, barbs[::-1], angles) * [-1, 1]
        tips = np.zeros((1, 2)), np.array([[random.uniform(0.7, 1.5), 0.0]])
        return np.concatenate([other_head, tips[0], tips[1], head + tips[1]])
    count, step = random.integers(2, 4), random.uniform(0.2, 0.5)
    path = np.concatenate([head[:: (-1) ** place] + np.array([step * place, 0.0]) for place in range(count)])
    return path * [random.choice([-1, 1]), 1]


def _wrong_rolls(random: np.random.Generator) -> np.ndarray:
    """Rolls with too many loops, with loops to both sides, or that climb."""

    def rolled(loops: int) -> np.ndarray:
        width = random.uniform(0.4, 1.2)
        lead = tuple(random.uniform(0.04, 0.4, 2))
        sizes = np.exp(random.uniform(0.0, 0.3) * random.normal(0.0, 1.0, (2, loops)))
        return shapes.roll(loops, sizes[0], width * sizes[1], width * random.uniform(0.3, 1.3), lead=lead)

    kind = random.integers(4)
    if kind < 2:
        many = 4 + int(min(random.geometric(0.5) - 1, 4))
        return rolled(many) * [1, random.choice([-1, 1])]
    first = rolled(int(random.integers(1, 4)))
    if kind == 2:
        return shapes.turned(first, random.choice([-1, 1]) * np.pi / 2 + random.normal(0.0, 0.2))
    second = rolled(int(random.integers(1, 3))) * [1, -1]
    return np.concatenate([first, second - second[0] + first[-1]]) * [1, random.choice([-1, 1])]


def _tailed_loop(random: np.random.Generator) -> np.ndarray:
    """A loop with a long tail at one end: no region, and no roll that goes on on both sides."""
    path = shapes.region(random.uniform(0.6, 1.0), (), random.random(), random.uniform(1.0, 1.1))
    way = shapes.turned(np.array([[random.uniform(0.6, 1.5), 0.0]]), random.uniform(0, 2 * np.pi))
    return np.concatenate([path, path[-1:] + way])


def _angles(random: np.random.Generator) -> np.ndarray:
    """A few straight pieces in any direction, the ends far apart."""
    while True:
        path = np.cumsum(random.normal(0.0, 1.0, (random.integers(4, 9), 2)), axis=0)
        if np.hypot(*(path[-1] - path[0])) > 0.4 * np.ptp(path, axis=0).max() and not _is_straight(path):
            return path


def _cursive(random: np.random.Generator) -> np.ndarray:
    """Writing of no language: the pen goes on to the right, by strokes, bows and loops of any size."""
    while True:
        steps = random.integers(4, 10)
        knots = np.stack([np.arange(steps) * random.uniform(0.2, 1.0), np.zeros(steps)], axis=1)
        path = _smooth(knots + random.normal(0.0, 0.7, (steps, 2)), random.uniform(0.02, 0.06))
        if not _is_straight(path):
            return path


def _is_straight(path: np.ndarray) -> bool:
    """Whether a path is so narrow that it is a line."""
    _, (length, width), _ = np.linalg.svd(path - path.mean(axis=0), full_matrices=False)
    return bool(width < 0.25 * length)


_KINDS = {
    _glyph: 7.0,
    _scribble: 2.5,
    _zigzag: 1.5,
    _wave: 1.5,
    _arc: 2.0,
    _coil: 2.0,
    _slanting_arrow: 2.0,
    _many_headed_arrow: 1.5,
    _wrong_rolls: 4.0,
    _tailed_loop: 2.0,
    _angles: 2.0,
    _cursive: 3.0,
}


def _smooth(path: np.ndarray, width: float) -> np.ndarray:
    return gaussian_filter1d(resample(path, 160).astype(np.float64), width * 160, axis=0, mode="nearest")
