"""Training examples without end: a face, drawn in one of many manners, and what it should become."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from torch.utils.data import IterableDataset, get_worker_info

from ..face.exaggeration import LEVELS
from ..geometry.view import View
from ..inference.matching import DrawnLines, shape_code
from ..inference.shape_code import ShapeModel
from ..sketch.hand import PARTS, Hand
from .drawings import DrawnExamples
from .face_table import FaceTable
from .manners import Drawn, Manner, draw
from .reshaping import Reshaping

# How often expressions are drawn, others once: people draw jaws, not puffed cheeks, and by hand mostly faces at rest.
# Only faces `of_model` are in all expressions alike, as in the paper.
_RARE = {"cheek_puff": 0.2, "blowfish": 0.2}
_BY_HAND = _RARE | {"neutral": 8.0, "smile": 3.0}
_LEVELS_BY_HAND = np.array([1.0, 0.8, 0.6, 0.4])  # how often people mean each level of exaggeration
_MISSED = 0.5  # standard deviations by which the lines that matching begins with miss the drawn ones
_AS_THEY_ARE = 0.6  # share of the faces of the people of the model that are not between two, as of the paper's 25,000
_OTHERS = 4  # people that a face is blended with
_QUIET_MOUTHS = ("neutral", "eyes_closed")  # what a face without a drawn mouth may be doing


@dataclass(frozen=True)
class Variety:
    """How drawings vary beyond the faces that they are drawn from; probabilities and standard deviations.

    Parameters
    ----------
    manners : dict of float
        Share of each `Manner`.
    wrinkles : float
        Share of drawings with wrinkle lines; people whose own are not known have somebody else's.
    of_model : float
        Share of exact and augmented drawings that show the people whom the face model is made of, as they are or
        between two of them and of their expressions: what the paper trains on.
    mixed : float
        Share of the other faces between two expressions.
    blended : float
        Share of the other faces of nobody in the table, blended from five people's: of people who are drawn again and
        again networks learn who they are, and little of others.
    partial : float
        Share of the freehand drawings that have only some of their parts.
    missing : float
        Chance that a part is missing from the others.
    view : float
        Noise of the view, degrees, in all but exact drawings.
    hand : Hand
        Who draws freehand.
    found : float
        Share of drawings whose lines are found as in a Studio, by matching lines that are near to their ink; of the
        others it is known which point is which.
    people : float
        Share of examples that are drawings by people, where there are some.
    """

    manners: dict[Manner, float] = field(
        default_factory=lambda: {Manner.EXACT: 0.3, Manner.AUGMENTED: 0.35, Manner.FREEHAND: 0.35}
    )
    wrinkles: float = 0.75
    of_model: float = 0.3
    mixed: float = 0.4
    blended: float = 0.5
    partial: float = 0.4
    missing: float = 0.06
    view: float = 2.5
    hand: Hand = field(default_factory=Hand)
    found: float = 0.35
    people: float = 0.1


@dataclass(frozen=True)
class _Face:
    """A face of the table, or a mixture of some: its lines and those of the same identity at rest, code and pose."""

    points: np.ndarray
    rest: np.ndarray
    code: np.ndarray
    pose: np.ndarray

    def mixed(self, other: _Face, share: float) -> _Face:
        mine, others = vars(self).values(), vars(other).values()
        return _Face(*(one + share * (two - one) for one, two in zip(mine, others, strict=True)))


def _blend(faces: list[_Face], weights: np.ndarray, middle: _Face) -> _Face:
    """The mean face and a sum of others' differences from it: with weights of length 1 faces vary as people do."""
    parts = zip(*(vars(face).values() for face in faces), strict=True)
    return _Face(
        *(
            mean + np.tensordot(weights, np.stack(part) - mean, axes=1)
            for part, mean in zip(parts, vars(middle).values(), strict=True)
        )
    )


class Batch(NamedTuple):
    """Sketches and what they should become.

    Parameters
    ----------
    images : (b, 1, 256, 256) bool array
    shapes : (b, p + q + r + 1) array
        Their lines, as `ShapeModel.describe` has them.
    codes : (b, k) array
        Of their faces, in the model's components.
    poses : (b, q) array
        Standardised expression weights.
    people : (b,) int array
        Row of the table of who each face is for the most part; -1 if nobody of it.
    """

    images: np.ndarray
    shapes: np.ndarray
    codes: np.ndarray
    poses: np.ndarray
    people: np.ndarray


class Batches(IterableDataset):
    """Batches without end. Every one has a number and by it a seed of its own: training resumes where it was.

    Parameters
    ----------
    seed : int
    start : int
        Number of batches already seen.
    stride : int
        Of every so many batches this takes one: the number of processes that train together.
    """

    def __init__(self, seed: int, start: int = 0, stride: int = 1) -> None:
        self.seed, self.start, self.stride = seed, start, stride

    def __iter__(self) -> Iterator[Batch]:
        worker = get_worker_info()
        first, step = (0, 1) if worker is None else (worker.id, worker.num_workers)
        number = self.start + self.stride * first
        while True:
            yield self.numbered(number)
            number += self.stride * step

    def numbered(self, number: int) -> Batch:
        """Batch `number`."""
        raise NotImplementedError


class Examples(Batches):
    """Batches of sketches with their shape codes, the codes and the expression weights of their faces.

    Parameters
    ----------
    table : FaceTable
    kept : (m,) int array
        Faces to draw, as numbers of the database: person after person, each in all expressions.
    people_of_model : int
        Rows of the table of the people whom the face model is made of; they are the first.
    expressions : list of str
    poses : (e, q) array
        Standardised weights of each expression.
    shape_model : ShapeModel
    variety : Variety
    batch : int
    seed : int
    reshaping : Reshaping, optional
        Gives half of the freehand drawings' faces other proportions than the table's.
    people : DrawnExamples, optional
        Drawings by people.
    pixels : bool
        Whether batches hold images; without them these are empty.
    """

    def __init__(
        self,
        table: FaceTable,
        kept: np.ndarray,
        people_of_model: int,
        expressions: list[str],
        poses: np.ndarray,
        shape_model: ShapeModel,
        variety: Variety,
        batch: int,
        seed: int,
        reshaping: Reshaping | None = None,
        people: DrawnExamples | None = None,
        pixels: bool = True,
    ) -> None:
        super().__init__(seed)
        self._pixels = pixels
        self.table, self.variety, self.batch = table, variety, batch
        self._kept, self._faces_of_model = kept, kept[kept < people_of_model * len(expressions)]
        self._is_kept = np.zeros(table.codes.shape[0] * len(expressions), dtype=bool)
        self._is_kept[kept] = True
        self._by_expression = [kept[kept % len(expressions) == expression] for expression in range(len(expressions))]
        self._neutral = expressions.index("neutral")
        self._quiet = [expressions.index(name) for name in _QUIET_MOUTHS if name in expressions]
        self._frequency, self._by_hand = (
            np.array([often.get(name, 1.0) for name in expressions]) for often in (_RARE, _BY_HAND)
        )
        self._poses = poses.astype(np.float32)
        self._middles = {number: self._middle(rows) for number, rows in enumerate(self._by_expression) if len(rows)}
        self._shape_model, self._reshaping, self._people = shape_model, reshaping, people
        self._manners, self._shares = list(variety.manners), list(variety.manners.values())

    def numbered(self, number: int) -> Batch:
        """Batch `number`."""
        random = np.random.default_rng([self.seed, number])
        drawn, codes, poses, people = zip(*(self.example(random) for _ in range(self.batch)), strict=True)
        points, seen = np.stack([one.points for one in drawn]), np.stack([one.seen for one in drawn])
        shapes = self._shape_model.describe(points, seen)
        for row in np.flatnonzero(random.random(len(drawn)) < self.variety.found):
            code = shapes[row, : self._shape_model.size]
            shapes[row] = found_shape(self._shape_model, code, points[row], seen[row], random)
        images = np.stack([one.image for one in drawn])[:, None]
        return Batch(images, shapes, np.stack(codes), np.stack(poses), np.array(people))

    def example(self, random: np.random.Generator) -> tuple[Drawn, np.ndarray, np.ndarray, int]:
        """One drawing, the code (k,) and expression weights (q,) of its face, and whose it is."""
        if self._people is not None and random.random() < self.variety.people:
            return *self._people.example(random), -1
        manner = self._manners[int(random.choice(len(self._manners), p=self._shares))]
        freehand = manner is Manner.FREEHAND
        parts: set[str] = self._parts(random) if freehand else set(PARTS)
        if not freehand and len(self._faces_of_model) and random.random() < self.variety.of_model:
            row, face = self._one_of_model(random)
        else:
            row, face = self._face(random, quiet="mouth" not in parts, freehand=freehand)
        points = self._overdrawn(face, random) if freehand else face.points
        donor = self._with_wrinkles(row, random) if random.random() < self.variety.wrinkles else None
        wrinkles = None if donor is None else self.table.wrinkles[divmod(donor, len(self._poses))]
        view = View() if manner is Manner.EXACT else noisy_view(self.variety.view, random)
        projected = self.table.lines(view.project(points))
        front = self.table.lines(View().project(self._stored(row if donor is None else donor).points))
        drawn = draw(manner, projected, parts, wrinkles, front, self.variety.hand, random, self._pixels)
        return drawn, face.code, face.pose, row // len(self._poses)

    def _with_wrinkles(self, row: int, random: np.random.Generator) -> int | None:
        """A face whose wrinkles are known: this one, or else somebody's in the same expression, at any level."""
        known = len(self.table.wrinkles) * len(self._poses)
        if row < known:
            return row
        others = self._by_expression[row % len(self._poses)]
        others = others[others < known]
        return int(others[random.integers(len(others))]) if len(others) else None

    def _parts(self, random: np.random.Generator) -> set[str]:
        if random.random() < self.variety.partial:
            keep, outline = random.uniform(0.0, 1.0), random.random() < 0.85
            chosen = {part for part in PARTS[1:] if random.random() < keep}
            return chosen | ({"outline"} if outline else set())
        return {part for part in PARTS if random.random() >= self.variety.missing}

    def _face(self, random: np.random.Generator, quiet: bool, freehand: bool) -> tuple[int, _Face]:
        """Number of a face and that face, or one blended or mixed of it and others, of which it is the most."""

        def pick() -> int:
            return self._pick_quiet(random) if quiet else self._pick(random, often)

        often = self._by_hand if freehand else self._frequency
        row = pick()
        while freehand and random.random() > _LEVELS_BY_HAND[row // len(self._poses) % LEVELS]:
            row = pick()
        expression = row % len(self._poses)
        rows, weights = np.array([row]), np.ones(1, np.float32)
        if random.random() < self.variety.blended:
            rows, weights = self._company(row, random)
        face = self._somebody(rows, weights)
        if not quiet and random.random() < self.variety.mixed:  # a weaker expression, or one between two
            other = self._neutral if random.random() < 0.6 else self._pick(random, self._frequency) % len(self._poses)
            step, most = other - expression, 0.7 if freehand else 0.5
            if self._is_kept[rows + step].all():
                face = face.mixed(self._somebody(rows + step, weights), random.uniform(0.0, most))
        if freehand and self._reshaping is not None and random.random() < 0.5:
            ratio = math.exp(random.normal(0.07, 0.16) / 2)  # of width and height, the area kept
            jaw, crown = random.normal(0.0, 0.2), random.normal(0.0, 0.07)
            amounts = {"width": ratio - 1, "height": 1 / ratio - 1, "jaw": jaw, "crown": crown}
            rest, _ = self._reshaping(face.rest, face.code, amounts)
            points, code = self._reshaping(face.points, face.code, amounts)
            face = _Face(points, rest, code, face.pose)
        return row, face

    def _one_of_model(self, random: np.random.Generator) -> tuple[int, _Face]:
        """Number of a face of the people of the model and that face, or one between it and another one of theirs."""
        one, other = random.choice(self._faces_of_model, 2)
        (person, expression), (somebody, another) = (divmod(int(row), len(self._poses)) for row in (one, other))
        rows = len(self._poses) * np.array([person, person, somebody, somebody]) + np.array([expression, another] * 2)
        if random.random() < _AS_THEY_ARE or not self._is_kept[rows].all():
            return int(one), self._stored(int(one))
        mine, mine_other, others, theirs = (self._stored(int(row)) for row in rows)
        share = random.uniform(0.0, 0.5)
        return int(one), mine.mixed(mine_other, share).mixed(others.mixed(theirs, share), share)

    def _overdrawn(self, face: _Face, random: np.random.Generator) -> np.ndarray:
        """Points (p, 3) with the expression of brows and mouth drawn stronger than it is, as people do."""
        drawn, at_rest = self.table.lines(face.points), self.table.lines(face.rest)
        for ending, most in (("brow", 2.8), ("mouth", 1.5)):
            if random.random() < 0.5:
                factor = random.uniform(1.0, most)
                for name in drawn:
                    if ending in name or (ending == "mouth" and name.startswith("lip")):
                        drawn[name] = at_rest[name] + factor * (drawn[name] - at_rest[name])
        return np.concatenate(list(drawn.values()))

    def _company(self, row: int, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """A face and others of its expression to blend it with, and their weights: its own is no less than a half."""
        others = random.choice(self._by_expression[row % len(self._poses)], _OTHERS)
        angle, direction = random.uniform(0.0, math.pi / 3), random.normal(size=_OTHERS)
        direction *= math.sin(angle) / np.linalg.norm(direction)
        return np.array([row, *others]), np.array([math.cos(angle), *direction], dtype=np.float32)

    def _somebody(self, rows: np.ndarray, weights: np.ndarray) -> _Face:
        """A face of the table, or one blended of several (k,) by their weights (k,)."""
        faces = [self._stored(int(row)) for row in rows]
        return faces[0] if len(faces) == 1 else _blend(faces, weights, self._middles[int(rows[0]) % len(self._poses)])

    def _stored(self, row: int) -> _Face:
        person, expression = divmod(row, len(self._poses))
        points = self.table.points[person]
        return _Face(
            points[expression].astype(np.float32),
            points[self._neutral].astype(np.float32),
            self.table.codes[person, expression],
            self._poses[expression],
        )

    def _middle(self, rows: np.ndarray) -> _Face:
        """The mean of some faces (m,) of one expression."""
        people, expressions = np.divmod(rows, len(self._poses))
        points, rest = (
            self.table.points[people, which].mean(axis=0, dtype=np.float32) for which in (expressions, self._neutral)
        )
        code, pose = self.table.codes[people, expressions].mean(axis=0), self._poses[expressions].mean(axis=0)
        return _Face(points, rest, code, pose)

    def _pick_quiet(self, random: np.random.Generator) -> int:
        """A face whose mouth is at rest; sometimes its eyes are closed."""
        expression = self._quiet[-1] if random.random() < 0.15 else self._quiet[0]
        rows = self._by_expression[expression]
        return int(rows[random.integers(len(rows))]) if len(rows) else self._pick(random, self._frequency)

    def _pick(self, random: np.random.Generator, frequency: np.ndarray) -> int:
        """A face, its expression by its frequency (e,) among the others."""
        while True:
            row = int(self._kept[random.integers(len(self._kept))])
            if frequency.max() * random.random() < frequency[row % len(self._poses)]:
                return row


def found_shape(
    model: ShapeModel, code: np.ndarray, points: np.ndarray, seen: np.ndarray, random: np.random.Generator
) -> np.ndarray:
    """What a Studio makes of the seen ones (n,) of points (n, 2), whose code it knows but for a little."""
    missed = code + random.normal(0.0, _MISSED, code.shape).astype(np.float32)
    ink = DrawnLines.of_points(points, seen).without_ears()
    return shape_code(model, model.decode(missed[None])[0], ink)


def noisy_view(degrees: float, random: np.random.Generator) -> View:
    """The front view, turned about each axis by normal angles of that standard deviation."""
    yaw, pitch, roll = np.radians(random.normal(0.0, degrees, 3))
    cx, sx, cy, sy, cz, sz = np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw), np.cos(roll), np.sin(roll)
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return View(about_z @ about_x @ about_y)
