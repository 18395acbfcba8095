"""How people draw a face: each feature in one of several manners, some left out, all of it with an unsteady hand.

Turns the exact lines of a face into one of many drawings of it: random removal and deformation of lines as in the
paper's section 4.4, and past it the shorthand of freehand drawings (a mouth as one line, an eye as an ellipse or a dot,
an oval head).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .names import SILHOUETTE
from .polyline import resample
from .wobble import misplace, trim, wobble

Lines = Mapping[str, np.ndarray]

PARTS = ("outline", "brows", "eyes", "nose", "mouth", "ears")
PART_LINES = {
    "brows": ("left_brow", "right_brow"),
    "eyes": ("left_eye_upper", "left_eye_lower", "right_eye_upper", "right_eye_lower"),
    "nose": ("nose",),
    "mouth": ("mouth_upper", "mouth_lower", "lip_upper", "lip_lower"),
    "ears": ("left_ear", "right_ear"),
}

_CLOSED_MOUTH = 0.012  # of the canvas: lips nearer than this are drawn as one line
_CLOSED_EYE = 0.2  # height over width


@dataclass(frozen=True)
class Hand:
    """How far a drawing strays from the lines of the face; canvas units.

    Parameters
    ----------
    tremor : float
        Bend of each line.
    misplacement : float
        Of each feature; of all of them together within the outline, twice as much.
    shorthand : float
        Chance that a feature is drawn in shorthand rather than line for line.
    extras : float
        Chance of strokes that belong to no line: hair, wrinkles, stubble, a beard.
    """

    tremor: float = 0.004
    misplacement: float = 0.006
    shorthand: float = 0.5
    extras: float = 0.25

    def intend(self, lines: Lines, random: np.random.Generator) -> dict[str, np.ndarray]:
        """The lines of a face where this hand means to put them: features out of place, the head more of an oval."""
        intended = dict(lines)
        together = random.normal(0, 2 * self.misplacement, 2) * [0.5, 1.0]
        for members in PART_LINES.values():
            names = [name for name in members if name in lines]
            moved = misplace([lines[name] for name in names], self.misplacement, 8 * self.misplacement, random)
            intended |= {name: line + together for name, line in zip(names, moved, strict=True)}
        silhouette = lines[SILHOUETTE]
        if random.random() < self.shorthand:
            silhouette = silhouette + random.uniform(0.2, 1.0) * (_oval(silhouette) - silhouette)
        return intended | {SILHOUETTE: silhouette}

    def draw(self, lines: Lines, parts: set[str], random: np.random.Generator) -> dict[str, list[np.ndarray]]:
        """Strokes by part: the given parts of a face, drawn once in some manner.

        Parameters
        ----------
        lines : mapping of (n, 2) arrays
            A face's lines on the canvas as `intend` gives them, by name; `lip_upper` and `lip_lower` are the outer
            contour of the lips.
        parts : set of str
            Which of "outline", "brows", "eyes", "nose", "mouth" and "ears" to draw.
        random : numpy Generator

        Returns
        -------
        dict of lists of (n, 2) arrays
            By part, with "extras" for what is none.
        """
        drawers = {"brows": _brows, "eyes": _eyes, "nose": _nose, "mouth": _mouth, "ears": _ears}
        drawn = {part: drawers[part](lines, random, self.shorthand) for part in sorted(parts - {"outline"})}
        if "outline" in parts:
            drawn["outline"] = _outline(lines[SILHOUETTE], random)
        if random.random() < self.extras:
            drawn["extras"] = _extras(lines[SILHOUETTE], random)
        tremor = self.tremor * random.exponential()
        return {part: [wobble(stroke, tremor, random) for stroke in strokes] for part, strokes in drawn.items()}


def _outline(points: np.ndarray, random: np.random.Generator) -> list[np.ndarray]:
    manner = random.random()
    if manner < 0.12:  # open at the top, where hair would be
        first = int(random.uniform(0.06, 0.2) * len(points))
        return [points[first : len(points) - first]]
    start = int(random.integers(len(points)))
    turned = np.concatenate([points[start:-1], points[: start + 1]])
    if manner < 0.25:  # in two or three strokes
        cuts = np.sort(random.choice(np.arange(20, len(turned) - 20), int(random.integers(1, 3)), replace=False))
        return [piece for piece in np.split(turned, cuts) if len(piece) > 2]
    if manner < 0.6:  # ends that miss each other
        return [turned[: len(turned) - int(random.uniform(0, 0.04) * len(turned))]]
    return [turned]


def _oval(points: np.ndarray) -> np.ndarray:
    """The upright ellipse about a closed line, point for point by direction from its middle."""
    low, high = points.min(axis=0), points.max(axis=0)
    direction = (points - (low + high) / 2) / (high - low)
    return (low + high) / 2 + direction / np.linalg.norm(direction, axis=1, keepdims=True) * (high - low) / 2


def _brows(lines: Lines, random: np.random.Generator, shorthand: float) -> list[np.ndarray]:
    thickness = random.uniform(0.008, 0.02) if random.random() < 0.3 else 0.0
    rounded = random.random() < shorthand
    strokes = []
    for name in ("left_brow", "right_brow"):
        brow = trim(lines[name], 0.12, random)
        if rounded:
            brow = _parabola(brow, random.uniform(0.8, 1.3))
        strokes.append(brow)
        if thickness:
            strokes.append(brow + np.array([0.0, thickness]))
    return strokes


def _eyes(lines: Lines, random: np.random.Generator, shorthand: float) -> list[np.ndarray]:
    manner = random.choice(["ellipse", "upper", "dot", "lens"], p=[0.4, 0.15, 0.25, 0.2])
    manner = manner if random.random() < shorthand else "contours"
    rounder, iris, filled = random.uniform(0.9, 1.7), random.random() < 0.5, random.random() < 0.5
    strokes = []
    for side in ("left", "right"):
        upper, lower = lines[f"{side}_eye_upper"], lines[f"{side}_eye_lower"]
        width = float(np.linalg.norm(upper[0] - upper[-1]))
        height = float(np.abs(upper[len(upper) // 2] - lower[len(lower) // 2])[1])
        middle = (upper[len(upper) // 2] + lower[len(lower) // 2]) / 2
        if height < _CLOSED_EYE * width:  # shut: one line, whatever the manner
            strokes += [lower] if manner != "contours" else [upper, lower]
            continue
        if manner == "contours":
            strokes += [upper, lower]
        elif manner == "lens":
            strokes += [_parabola(upper, rounder), _parabola(lower, rounder)]
        elif manner == "upper":
            strokes += [upper]
        elif manner == "ellipse":
            strokes += [_ellipse(middle, width / 2, min(height * rounder, 1.1 * width) / 2)]
        else:
            strokes += _disc(middle, random.uniform(0.006, 0.016))
        if iris and manner != "dot":
            strokes += _disc(middle, 0.42 * height) if filled else [_ellipse(middle, 0.42 * height, 0.42 * height)]
    return strokes


def _nose(lines: Lines, random: np.random.Generator, shorthand: float) -> list[np.ndarray]:
    nose, count = lines["nose"], len(lines["nose"])
    if random.random() >= shorthand:
        return [trim(nose, 0.1, random)]
    root = (lines["left_brow"][0] + lines["right_brow"][0]) / 2
    wing = (nose[0], nose[-1])[int(random.integers(2))]
    tip = nose[count // 2]
    manner = random.choice(["base", "half", "angle", "bridge", "nostrils", "curve"])
    if manner == "base":
        return [nose[int(0.25 * count) : int(0.75 * count)]]
    if manner == "half":
        return [nose[: int(0.6 * count)] if wing is nose[0] else nose[int(0.4 * count) :]]
    if manner == "angle":  # down one side of the ridge, then across
        top = root + random.uniform(0.1, 0.6) * (tip - root)
        foot = np.array([wing[0], tip[1]])
        return [np.stack([top, foot, tip])]
    if manner == "bridge":
        sides = [root + random.uniform(0.15, 0.4) * (end - root) for end in (nose[0], nose[-1])]
        return [
            np.stack([sides[0], nose[0]]),
            np.stack([sides[1], nose[-1]]),
            nose[int(0.1 * count) : int(0.9 * count)],
        ]
    if manner == "nostrils":
        return [stroke for share in (0.3, 0.7) for stroke in _disc(nose[int(share * count)], 0.008)]
    return [_parabola(np.stack([nose[0], tip, nose[-1]]), 1.0)]


def _mouth(lines: Lines, random: np.random.Generator, shorthand: float) -> list[np.ndarray]:
    upper, lower = resample(lines["mouth_upper"], 33), resample(lines["mouth_lower"], 33)
    lips = [lines["lip_upper"], lines["lip_lower"]]
    if np.abs(upper - lower).max() < _CLOSED_MOUTH:
        line = (upper + lower) / 2
        # Seen from outside the lips' corners are part of the mouth.
        line = np.concatenate([lips[0][:1], line, lips[0][-1:]])
        if random.random() < shorthand:
            return [_parabola(line, random.uniform(1.0, 1.8))]
        manner = random.random()
        return [line, *lips] if manner < 0.45 else ([upper, lower] if manner < 0.6 else [line])
    manner = random.random()
    if manner < 0.4:
        return [upper, lower]
    if manner < 0.75:
        return [upper, lower, *lips]
    if manner < 0.9:
        return lips
    return [upper, lower, (upper + random.uniform(0.2, 0.4) * (lower - upper))]  # a row of teeth


def _ears(lines: Lines, random: np.random.Generator, shorthand: float) -> list[np.ndarray]:
    rounded, inner = random.random() < shorthand, random.random() < 0.25
    strokes = []
    for side in ("left", "right"):
        ear = lines[f"{side}_ear"]
        ear = trim(_parabola(ear, 1.0, axis=0) if rounded else ear, 0.1, random)
        strokes.append(ear)
        if inner:
            strokes.append(ear.mean(axis=0) + 0.5 * (ear - ear.mean(axis=0)))
    return strokes


def _extras(outline: np.ndarray, random: np.random.Generator) -> list[np.ndarray]:
    """Short curved strokes inside the head: a beard along the chin, or hair above, wrinkles or stubble anywhere."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    if random.random() < 0.2:
        return _beard(outline, random)
    reach = 0.25 if random.random() < 0.6 else 1.0
    strokes = []
    for _ in range(int(random.integers(1, 7))):
        start = low + (high - low) * random.uniform([0.2, 0.02], [0.8, reach])
        step = random.normal(0, 0.03, 2)
        strokes.append(np.stack([start, start + step + random.normal(0, 0.01, 2), start + 2 * step]))
    return strokes


def _beard(outline: np.ndarray, random: np.random.Generator) -> list[np.ndarray]:
    """A row of strokes up from the chin, all alike."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    reach, length, bend = random.uniform(0.1, 0.35), random.uniform(0.05, 0.16), random.normal(0, 0.1)
    strokes = []
    for x in np.linspace(0.5 - reach, 0.5 + reach, int(random.integers(4, 11))):
        chin = outline[np.argmin(np.abs(outline - (low + (high - low) * [x, 1.0])).sum(axis=1))]
        hair = np.array([[0.0, 0.02], [bend, 0.5], [0.0, 1.0]]) * [length, -length] * (high[1] - low[1])
        strokes.append(chin + hair + random.normal(0, 0.004, 2))
    return strokes


def _parabola(points: np.ndarray, bend: float, axis: int = 1) -> np.ndarray:
    """The parabola nearest to a line as a function of its other coordinate, its bend scaled about the chord."""
    across, along = points[:, axis], points[:, 1 - axis]
    start, end = along[0], along[-1]
    if start == end:
        return points
    t = np.linspace(0.0, 1.0, 24)
    share = (along - start) / (end - start)
    chord = across[0] + share * (across[-1] - across[0])
    hump = share * (1 - share)
    height = float((hump * (across - chord)).sum() / max((hump**2).sum(), 1e-12))
    highest = 6 * np.abs(across - chord).max()  # no more than half as high again as the line itself
    height = float(np.clip(height, -highest, highest))
    fitted = np.empty((len(t), 2))
    fitted[:, 1 - axis] = start + t * (end - start)
    fitted[:, axis] = across[0] + t * (across[-1] - across[0]) + bend * height * t * (1 - t)
    return fitted


def _ellipse(middle: np.ndarray, half_width: float, half_height: float) -> np.ndarray:
    angle = np.linspace(0, 2 * np.pi, 25)
    return middle + np.stack([half_width * np.cos(angle), half_height * np.sin(angle)], axis=1)


def _disc(middle: np.ndarray, radius: float) -> list[np.ndarray]:
    return [_ellipse(middle, share * radius, share * radius) for share in (1.0, 0.4)]
