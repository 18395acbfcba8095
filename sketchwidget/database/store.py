"""The database on disk: one zarr group in which whole identities are written, each with a sum of its bytes."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any
from warnings import catch_warnings, simplefilter

import numpy as np
import zarr
from zarr.errors import GroupNotFoundError

from ..face.exaggeration import LEVELS

FORMAT = "sketchwidget face database"
VERSION = 1
WRINKLES, WRINKLE_POINTS = 48, 12  # as many wrinkles as a face may have, and the points of each

_SUM = hashlib.sha256().digest_size


@dataclass(frozen=True)
class Plan:
    """What a database holds; one that was begun is only ever finished with the same plan.

    Parameters
    ----------
    source : str
        Name of the source of its faces.
    identities : int
    expressions : tuple of str
    vertices : int
        Coarse vertices of a head.
    seed : int
        Of the random pairs that further faces are interpolated from.
    interpolated : int
        How many those are.
    """

    source: str
    identities: int
    expressions: tuple[str, ...]
    vertices: int
    seed: int = 7
    interpolated: int = 10_000


@dataclass(frozen=True)
class Heads:
    """One identity at all levels and in all expressions.

    Parameters
    ----------
    vertices : (levels, e, n, 3) float32 array
        Coarse, millimetres.
    wrinkles : (levels, e, 48, 12, 2) float32 array
        Wrinkle lines on the canvas, resampled; NaN where there are no more.
    crossing : (levels, e, 2) int16 array
        Pairs of triangles that cut each other: of the lips, and of lids and eyeballs.
    """

    vertices: np.ndarray
    wrinkles: np.ndarray
    crossing: np.ndarray

    def sum(self) -> np.ndarray:
        """SHA-256 of the arrays, (32,) uint8."""
        digest = hashlib.sha256()
        for array in (self.vertices, self.wrinkles, self.crossing):
            digest.update(np.ascontiguousarray(array).tobytes())
        return np.frombuffer(digest.digest(), dtype=np.uint8)


class Store:
    """The arrays of a database by identity, level and expression.

    Parameters
    ----------
    path : Path
    group : zarr.Group
    plan : Plan
    """

    def __init__(self, path: Path, group: zarr.Group, plan: Plan) -> None:
        self.path, self.plan, self._group = path, plan, group

    @classmethod
    def create(cls, path: Path, plan: Plan) -> Store:
        """Begin a database in a new or empty folder, or go on with one.

        Raises
        ------
        ValueError
            If the folder holds something else, or a database of another plan.
        OSError
            If it cannot be written.
        """
        if path.exists() and (not path.is_dir() or any(path.iterdir())):
            store = cls.open(path)
            if store.plan != plan:
                raise ValueError(f"{path} holds another database, of {store.plan}: choose another folder or remove it")
            return store
        group = zarr.open_group(path, mode="w")
        shape = (plan.identities, LEVELS, len(plan.expressions))
        whole = (1, 1, len(plan.expressions))
        lines = (WRINKLES, WRINKLE_POINTS, 2)
        for name, cell, kind in (
            ("vertices", (plan.vertices, 3), "float32"),
            ("wrinkles", lines, "float32"),
            ("crossing", (2,), "int16"),
        ):
            group.create_array(name, shape=shape + cell, chunks=whole + cell, dtype=kind)
        group.create_array("sums", shape=(plan.identities, _SUM), chunks=(1, _SUM), dtype="uint8")
        group.attrs.update({"format": FORMAT, "version": VERSION, "plan": asdict(plan)})
        return cls(path, group, plan)

    @classmethod
    def open(cls, path: Path) -> Store:
        """A database that is there, finished or not.

        Raises
        ------
        FileNotFoundError
            If the folder holds none.
        ValueError
            If it is of another version, or damaged.
        """
        try:
            group = zarr.open_group(path, mode="r+")
        except (GroupNotFoundError, FileNotFoundError, NotADirectoryError) as error:
            raise FileNotFoundError(
                f"{path} holds no face database: `sketchwidget database --out {path}` builds one"
            ) from error
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"{path / 'zarr.json'} is damaged: remove {path} and build it again") from error
        about: dict[str, Any] = dict(group.attrs)
        if about.get("format") != FORMAT:
            raise ValueError(f"{path} is no face database: its format is {about.get('format')!r}")
        if about.get("version") != VERSION:
            raise ValueError(
                f"{path} has version {about.get('version')!r} of the format, and this sketchwidget reads {VERSION}"
            )
        try:
            plan = Plan(**about["plan"] | {"expressions": tuple(about["plan"]["expressions"])})
            missing = {"vertices", "wrinkles", "crossing", "sums"} - _array_names(group)
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"{path / 'zarr.json'} is damaged: remove {path} and build it again") from error
        if missing:
            raise ValueError(f"{path} lacks {', '.join(sorted(missing))}: remove it and build it again")
        return cls(path, group, plan)

    def array(self, name: str) -> zarr.Array:
        """One of "vertices", "wrinkles", "crossing" and "sums"."""
        array = self._group[name]
        assert isinstance(array, zarr.Array)
        return array

    def write(self, number: int, heads: Heads) -> None:
        """Keep an identity; its sum comes last, so that one half written does not count."""
        self.array("vertices")[number] = heads.vertices
        self.array("wrinkles")[number] = heads.wrinkles
        self.array("crossing")[number] = heads.crossing
        self.array("sums")[number] = heads.sum()

    def read(self, number: int) -> Heads:
        """An identity that was kept.

        Raises
        ------
        OSError
            If its files are damaged.
        """
        try:
            arrays = [np.asarray(self.array(name)[number]) for name in ("vertices", "wrinkles", "crossing")]
        except Exception as error:  # whatever a codec makes of damaged bytes
            raise OSError(
                f"{self.path}: identity {number} cannot be read; the command that built the database mends it"
            ) from error
        return Heads(*arrays)

    def missing(self) -> list[int]:
        """Identities that were not kept yet, or are damaged."""
        sums = np.asarray(self.array("sums")[:])
        return [number for number in range(self.plan.identities) if not self._is_whole(number, sums[number])]

    def _is_whole(self, number: int, kept: np.ndarray) -> bool:
        if not kept.any():
            return False
        try:
            return bool((self.read(number).sum() == kept).all())
        except OSError:
            return False

    def sum(self) -> str:
        """SHA-256 over all identities: the same for the same faces, whatever the order they were made in."""
        return hashlib.sha256(np.asarray(self.array("sums")[:]).tobytes()).hexdigest()


def _array_names(group: zarr.Group) -> set[str]:
    with catch_warnings():
        simplefilter("ignore", UserWarning)  # zarr wonders at the model's file beside the arrays
        return set(group.array_keys())
