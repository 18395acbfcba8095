"""Builds a database of faces: identities x expressions x levels, their wrinkles, and a bilinear model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from joblib.externals.loky.process_executor import TerminatedWorkerError
from tqdm import tqdm

from ..face.decomposition import COMPONENTS, RANK, decompose
from ..face.drawing import draw
from ..face.exaggeration import LEVELS, Exaggeration
from ..face.model import FaceModel
from ..face.template import Template
from ..face.wrinkles import Wrinkles
from ..geometry.view import View
from ..sketch import WRINKLE, resample_each
from .contact import Contact
from .posing import to_millimetres
from .source import FaceSource
from .store import WRINKLE_POINTS, WRINKLES, Heads, Plan, Store

MODEL = "face.safetensors"

MODEL_IDENTITIES = 150  # the first ones, as in the paper; further ones are for networks to learn from
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
        vertices = self._exaggerated(number, self._contact.mended)
        vertices = np.stack([[self._contact.seated(head) for head in heads] for heads in vertices])
        each = vertices.reshape(-1, *vertices.shape[-2:])
        crossing = np.array([tuple(self._contact.crossing(head).values()) for head in each], dtype=np.int16)
        wrinkles = np.stack([self._wrinkled(head) for head in each])
        shape = vertices.shape[:2]
        return Heads(vertices, wrinkles.reshape(*shape, *wrinkles.shape[1:]), crossing.reshape(*shape, 2))

    def skin(self, number: int) -> np.ndarray:
        """The vertices of one identity without what takes most of the time: teeth may come through the skin.

        Returns
        -------
        (levels, e, n, 3) array
            Coarse, millimetres.
        """
        return self._exaggerated(number, self._contact.parted)

    def _exaggerated(self, number: int, mend: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """One identity (levels, e, n, 3), each of its heads mended before they are exaggerated."""
        try:
            posed = self.scale * (self.source.heads(number) - self.origin)
            posed = np.stack([mend(head) for head in posed])
            return self._exaggeration(posed[self.source.expressions.index("neutral")], posed)
        except ValueError as error:
            raise ValueError(f"identity {number} of the source {self.source.name}: {error}") from error

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
    maker = prepare(source, identities)
    store.require_frame(maker.scale, maker.origin)
    if missing := store.missing():
        (out / MODEL).unlink(missing_ok=True)
        goes = [missing[start : start + _TOGETHER] for start in range(0, len(missing), _TOGETHER)]
        made = in_processes((delayed(_make)(maker, go) for go in goes), jobs)
        with tqdm(total=identities, initial=identities - len(missing), desc="identities", unit="head") as bar:
            for heads in made:
                for number, identity in heads:
                    store.write(number, identity)
                    bar.update()
    if not _is_sound(out / MODEL):
        decomposed(store, source.template).save(out / MODEL, provenance or {})
    return store


def in_processes(calls: Iterable[Any], jobs: int | None) -> Iterator[Any]:
    """What joblib's delayed calls give, in whatever order they end.

    Raises
    ------
    OSError
        If a process is killed.
    """
    try:
        yield from Parallel(n_jobs=jobs, return_as="generator_unordered")(calls)
    except TerminatedWorkerError as error:
        raise OSError(
            "a process of the build was killed, most likely for lack of memory: give fewer --jobs; what is built stays,"
            " and the same command goes on"
        ) from error


def prepare(source: FaceSource, identities: int) -> Maker:
    """The maker of a source's heads, its frame taken from the mean of the model's identities at rest."""
    measured = range(min(identities, MODEL_IDENTITIES))
    mean = np.mean([source.rest(number) for number in tqdm(measured, "measuring", unit="head", leave=False)], axis=0)
    scale, origin = to_millimetres(source.template.subdivision @ mean, source.template)
    return Maker(source, scale, origin, scale * (mean - origin))


def decomposed(store: Store, template: Template, rank: tuple[int, int] = RANK) -> FaceModel:
    """The bilinear model of a database (paper 4.2): of its first 150 identities at all levels, in all expressions.

    Parameters
    ----------
    store : Store
    template : Template
        Of its heads.
    rank : (int, int)
        Identity and expression size; as much of it as there are people and expressions.

    Returns
    -------
    FaceModel
        Its mean identity is that of the people as they are, at level 1.
    """
    plan = store.plan
    identities = min(plan.identities, MODEL_IDENTITIES)
    people = identities * LEVELS
    tensor = np.empty((people, len(plan.expressions), 3 * plan.vertices), dtype=np.float32)
    for number in tqdm(range(identities), desc="decomposing", unit="head", leave=False):
        heads = store.read(number).vertices
        tensor[number * LEVELS : (number + 1) * LEVELS] = heads.reshape(LEVELS, len(plan.expressions), -1)
    bilinear = decompose(tensor, (min(rank[0], people), min(rank[1], len(plan.expressions))), COMPONENTS)
    return FaceModel(template, bilinear, list(plan.expressions), bilinear.identities[::LEVELS].mean(axis=0))


def _is_sound(model: Path) -> bool:
    try:
        FaceModel.load(model)
    except (FileNotFoundError, ValueError):
        return False
    return True


def _make(maker: Maker, numbers: Iterable[int]) -> list[tuple[int, Heads]]:
    return [(number, maker(number)) for number in numbers]
