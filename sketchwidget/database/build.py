"""Builds a database of faces: identities x expressions x levels, their wrinkles, and the bilinear model of them all."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from tqdm import tqdm

from ..face.decomposition import COMPONENTS, RANK, decompose
from ..face.drawing import draw
from ..face.exaggeration import LEVELS, Exaggeration
from ..face.model import FaceModel
from ..face.wrinkles import Wrinkles
from ..geometry.view import View
from ..sketch import WRINKLE, resample_each
from .contact import Contact
from .posing import to_millimetres
from .source import FaceSource
from .store import WRINKLE_POINTS, WRINKLES, Heads, Plan, Store

MODEL = "face.safetensors"

_TOGETHER = 3  # identities that a process makes in one go; each go reads the source anew


@dataclass(frozen=True)
class Preset:
    """How much to build; "paper" is the size of DeepSketch2Face's database."""

    identities: int
    interpolated: int


PRESETS = {"tiny": Preset(identities=2, interpolated=20), "paper": Preset(identities=150, interpolated=10_000)}


@dataclass(frozen=True)
class Maker:
    """Makes the heads of one identity after the other.

    Parameters
    ----------
    source : FaceSource
    scale : float
    origin : (3,) array
        ``scale * (head - origin)`` is a head in the canonical frame.
    typical : (n, 3) array
        A typical head at rest, coarse, in that frame.
    """

    source: FaceSource
    scale: float
    origin: np.ndarray
    typical: np.ndarray

    def __call__(self, number: int) -> Heads:
        """One identity at all levels and in all expressions."""
        posed = self.scale * (self.source.heads(number) - self.origin)
        posed = np.stack([self._contact.mended(head) for head in posed])
        rest = posed[self.source.expressions.index("neutral")]
        vertices = self._exaggeration(rest, posed)
        each = vertices.reshape(-1, *vertices.shape[-2:])
        crossing = np.array([tuple(self._contact.crossing(head).values()) for head in each], dtype=np.int16)
        wrinkles = np.stack([self._wrinkled(head) for head in each])
        shape = vertices.shape[:2]
        return Heads(vertices, wrinkles.reshape(*shape, *wrinkles.shape[1:]), crossing.reshape(*shape, 2))

    def _wrinkled(self, head: np.ndarray) -> np.ndarray:
        template = self.source.template
        lines = draw(template, template.subdivision @ head, View(), self._wrinkles).lines.get(WRINKLE, [])
        kept = np.full((WRINKLES, WRINKLE_POINTS, 2), np.nan, dtype=np.float32)
        kept[: len(lines)] = resample_each(lines[:WRINKLES], WRINKLE_POINTS)
        return kept

    @cached_property
    def _contact(self) -> Contact:
        return Contact(self.source.template, self.typical)

    @cached_property
    def _exaggeration(self) -> Exaggeration:
        return Exaggeration(self.source.template, self.typical)

    @cached_property
    def _wrinkles(self) -> Wrinkles:
        return Wrinkles(self.source.template, self.source.template.subdivision @ self.typical)


def build(
    source: FaceSource,
    out: Path,
    identities: int,
    interpolated: int,
    jobs: int | None = 1,
    provenance: dict[str, str] | None = None,
) -> Store:
    """Build a database, or go on with one that was begun.

    Parameters
    ----------
    source : FaceSource
    out : Path
        Folder of the database.
    identities, interpolated : int
    jobs : int or None
        Processes of joblib's backend; None leaves their number to `joblib.parallel_config`.
    provenance : dict of str, optional
        What the header of the model's file says of where it came from.

    Raises
    ------
    ValueError
        If the source has fewer identities, or the folder holds another database.
    OSError
        If a file cannot be read or written; what is already built stays good.
    """
    if source.count is not None and identities > source.count:
        raise ValueError(
            f"the source {source.name} has {source.count} identities; {identities} were asked for: give --identities"
        )
    plan = Plan(source.name, identities, source.expressions, source.template.coarse_count, interpolated=interpolated)
    store = Store.create(out, plan)
    if missing := store.missing():
        maker = prepare(source, identities)
        store.require_frame(maker.scale, maker.origin)
        (out / MODEL).unlink(missing_ok=True)
        goes = [missing[start : start + _TOGETHER] for start in range(0, len(missing), _TOGETHER)]
        made: Any = Parallel(n_jobs=jobs, return_as="generator_unordered")(delayed(_make)(maker, go) for go in goes)
        with tqdm(total=identities, initial=identities - len(missing), desc="identities", unit="head") as bar:
            for heads in made:
                for number, identity in heads:
                    store.write(number, identity)
                    bar.update()
    if not _is_sound(out / MODEL):
        unfinished = out / f"{MODEL}.part"
        decomposed(store, source).save(unfinished, provenance or {})
        unfinished.rename(out / MODEL)
    return store


def prepare(source: FaceSource, identities: int) -> Maker:
    """The maker of a source's heads, its frame taken from the mean of the identities at rest."""
    neutral = source.expressions.index("neutral")
    total = np.zeros((source.template.coarse_count, 3))
    for number in tqdm(range(identities), desc="measuring", unit="head", leave=False):
        total += source.heads(number)[neutral]
    mean = total / identities
    scale, origin = to_millimetres(source.template.subdivision @ mean, source.template)
    return Maker(source, scale, origin, scale * (mean - origin))


def decomposed(store: Store, source: FaceSource) -> FaceModel:
    """The bilinear model of all identities at all levels, in all expressions (paper 4.2)."""
    plan = store.plan
    people = plan.identities * LEVELS
    tensor = np.empty((people, len(plan.expressions), 3 * plan.vertices), dtype=np.float32)
    for number in tqdm(range(plan.identities), desc="decomposing", unit="head", leave=False):
        heads = store.read(number).vertices
        tensor[number * LEVELS : (number + 1) * LEVELS] = heads.reshape(LEVELS, len(plan.expressions), -1)
    rank = (min(RANK[0], people), min(RANK[1], len(plan.expressions)))
    return FaceModel(source.template, decompose(tensor, rank, COMPONENTS), list(plan.expressions))


def _is_sound(model: Path) -> bool:
    try:
        FaceModel.load(model)
    except (FileNotFoundError, ValueError):
        return False
    return True


def _make(maker: Maker, numbers: Iterable[int]) -> list[tuple[int, Heads]]:
    return [(number, maker(number)) for number in numbers]
