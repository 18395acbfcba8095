"""Training examples without end: a face, drawn by one of many hands, and what it should become."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from torch.utils.data import IterableDataset, get_worker_info

from ..geometry.view import View
from ..inference.framing import Frame
from ..sketch import SILHOUETTE, rasterise
from ..sketch.hand import Hand
from .face_table import FaceTable, Reshaping

Stored = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]

PARTS = ("outline", "brows", "eyes", "nose", "mouth", "ears")
_RARE = {"cheek_puff": 0.2, "blowfish": 0.2}  # how often, others always: people draw jaws, not puffed cheeks
_QUIET_MOUTHS = ("neutral", "eyes_closed")  # what a face without a drawn mouth may be doing


@dataclass(frozen=True)
class Variety:
    """How drawings vary beyond the faces that they are drawn from; probabilities and standard deviations.

    Parameters
    ----------
    partial : float
        Share of drawings that have only some of their parts.
    missing : float
        Chance that a part is missing from the others.
    view : float
        Noise of the view, degrees.
    hand : Hand or None
        Who draws; None draws every line exactly.
    """

    partial: float = 0.4
    missing: float = 0.06
    view: float = 2.5
    hand: Hand | None = field(default_factory=Hand)


class Examples(IterableDataset):
    """Batches of sketches with the codes and the expression weights of their faces.

    Parameters
    ----------
    table : FaceTable
    expressions : list of str
    poses : (e, q) array
        Standardised weights of each expression.
    variety : Variety
    batch : int
    seed : int
    start : int
        Number of batches already seen; every batch has a seed of its own, so that training resumes where it was.
    left_out : (i, e) bool array, optional
        Faces never drawn from.
    reshaping : Reshaping, optional
        Gives half of the faces other proportions than the table's.
    """

    def __init__(
        self,
        table: FaceTable,
        expressions: list[str],
        poses: np.ndarray,
        variety: Variety,
        batch: int,
        seed: int,
        start: int = 0,
        left_out: np.ndarray | None = None,
        reshaping: Reshaping | None = None,
    ) -> None:
        self.table, self.variety, self.batch, self.seed, self.start = table, variety, batch, seed, start
        self._neutral = expressions.index("neutral")
        self._quiet = [expressions.index(name) for name in _QUIET_MOUTHS if name in expressions]
        self._frequency = np.array([_RARE.get(name, 1.0) for name in expressions])
        self._poses = poses.astype(np.float32)
        self._left_out = np.zeros(table.codes.shape[:2], dtype=bool) if left_out is None else left_out
        self._reshaping = reshaping
        self._mean_code = table.codes[:, self._neutral].mean(axis=0)
        self._mean_points = table.points[:, self._neutral].astype(np.float32).mean(axis=0)

    def __iter__(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        worker = get_worker_info()
        number, step = (self.start, 1) if worker is None else (self.start + worker.id, worker.num_workers)
        while True:
            random = np.random.default_rng([self.seed, number])
            made = [self.example(random) for _ in range(self.batch)]
            images, codes, poses = (np.stack(values) for values in zip(*made, strict=True))
            yield images[:, None], codes, poses
            number += step

    def example(self, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """One sketch (256, 256) bool, and the code (k,) and expression weights (q,) of its face."""
        parts = self._parts(random)
        points, code, pose = self._face(random, quiet="mouth" not in parts)
        return draw_example(self.table.lines(points), parts, self.variety, random), code, pose

    def _parts(self, random: np.random.Generator) -> set[str]:
        if random.random() < self.variety.partial:
            keep, outline = random.uniform(0.0, 1.0), random.random() < 0.85
            chosen = {part for part in PARTS[1:] if random.random() < keep}
            return chosen | ({"outline"} if outline else set())
        return {part for part in PARTS if random.random() >= self.variety.missing}

    def _face(self, random: np.random.Generator, quiet: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Line points (p, 3), code and expression weights of a face: one of the table, or a mixture of some."""
        identity, expression = self._pick(random)
        if quiet:
            expression = self._quiet[-int(random.random() < 0.15)]
        points, rest, code, pose = self._stored(identity, expression)
        if not quiet and random.random() < 0.35:  # a weaker expression, or one between two
            other = self._neutral if random.random() < 0.6 else self._pick(random)[1]
            points, rest, code, pose = _mix(
                (points, rest, code, pose), self._stored(identity, other), random.uniform(0.0, 0.7)
            )
        if random.random() < 0.3:  # somebody between two people
            other = self._stored(self._pick(random)[0], expression)
            points, rest, code, pose = _mix((points, rest, code, pose), other, random.uniform(0.0, 0.5))
        if random.random() < 0.15:  # an exaggerated face
            more = random.uniform(0.1, 0.5)
            _, own, own_code, _ = self._stored(identity, self._neutral)
            points, rest = points + more * (own - self._mean_points), rest + more * (own - self._mean_points)
            code = code + more * (own_code - self._mean_code)
        if self._reshaping is not None and random.random() < 0.5:
            ratio = math.exp(random.normal(0.07, 0.13) / 2)  # of width and height, the area kept
            jaw, crown = random.normal(0.0, 0.2), random.normal(0.0, 0.07)
            amounts = {"width": ratio - 1, "height": 1 / ratio - 1, "jaw": jaw, "crown": crown}
            rest, _ = self._reshaping(rest, code, amounts)
            points, code = self._reshaping(points, code, amounts)
        return self._overdrawn(points, rest, random), code, pose

    def _overdrawn(self, points: np.ndarray, rest: np.ndarray, random: np.random.Generator) -> np.ndarray:
        """Points (p, 3) with the expression of brows and mouth drawn stronger than it is, as people do."""
        drawn = self.table.lines(points)
        at_rest = self.table.lines(rest)
        for ending, most in (("brow", 2.8), ("mouth", 1.5)):
            if random.random() < 0.5:
                factor = random.uniform(1.0, most)
                for name in drawn:
                    if ending in name or (ending == "mouth" and name.startswith("lip")):
                        drawn[name] = at_rest[name] + factor * (drawn[name] - at_rest[name])
        return np.concatenate(list(drawn.values()))

    def _stored(self, identity: int, expression: int) -> Stored:
        """Line points (p, 3) of a face and of the same identity at rest, the face's code and its expression weights."""
        points = self.table.points[identity]
        return (
            points[expression].astype(np.float32),
            points[self._neutral].astype(np.float32),
            self.table.codes[identity, expression],
            self._poses[expression],
        )

    def _pick(self, random: np.random.Generator) -> tuple[int, int]:
        while True:
            identity, expression = (int(random.integers(size)) for size in self._left_out.shape)
            if not self._left_out[identity, expression] and random.random() < self._frequency[expression]:
                return identity, expression


def _mix(face: Stored, other: Stored, share: float) -> Stored:
    points, rest, code, pose = (one + share * (two - one) for one, two in zip(face, other, strict=True))
    return points, rest, code, pose


def draw_example(
    lines: dict[str, np.ndarray], parts: set[str], variety: Variety, random: np.random.Generator
) -> np.ndarray:
    """A face's lines (n, 3), in millimetres, drawn and normalised as a network sees them: (256, 256) bool."""
    view = _noisy_view(variety.view, random)
    projected = {name: view.project(line) for name, line in lines.items()}
    if variety.hand is None:
        drawn = {"outline": [projected.pop(SILHOUETTE)], "inside": list(projected.values())}
    else:
        drawn = variety.hand.draw(projected, parts, random)
    frame = Frame.of_outline(np.concatenate(drawn["outline"])) if "outline" in drawn else Frame()
    strokes = [frame(stroke) for part in drawn.values() for stroke in part]
    return rasterise(strokes)


def _noisy_view(degrees: float, random: np.random.Generator) -> View:
    yaw, pitch, roll = np.radians(random.normal(0.0, degrees, 3))
    cx, sx, cy, sy, cz, sz = np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw), np.cos(roll), np.sin(roll)
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return View(about_z @ about_x @ about_y)
