"""The database on disk: one zarr group in which whole identities are written, each with a sum of its bytes."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from zarr.codecs import ZstdCodec
from zarr.errors import GroupNotFoundError

from ..face.exaggeration import LEVELS

FORMAT = "sketchwidget face database"
VERSION = 1
WRINKLES, WRINKLE_POINTS = 48, 12  # as many wrinkles as a face may have, and the points of each

_SUM = hashlib.sha256().digest_size
_ANEW = "remove {} and build it again"


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
        FileExistsError
            If there is a file of that name, or the folder holds something else.
        ValueError
            If the folder holds a database that is damaged, or one of another plan.
        OSError
            If it cannot be written.
        """
        if path.exists() and (not path.is_dir() or any(path.iterdir())):
            try:
                group, found = _open(path)
            except FileNotFoundError as error:
                raise FileExistsError(
                    f"{path} is there and no face database: name a new folder, or remove it"
                ) from error
            if found != plan:
                others = [
                    f"{name} {was!r}, not {asdict(plan)[name]!r}"
                    for name, was in asdict(found).items()
                    if was != asdict(plan)[name]
                ]
                raise ValueError(
                    f"{path} holds another database, of {'; '.join(others)}: name another folder or remove it"
                )
        else:
            with _writing(path):
                about = {"format": FORMAT, "version": VERSION, "plan": asdict(plan)}
                group = zarr.open_group(path, mode="w", attributes=about)
        shape = (plan.identities, LEVELS, len(plan.expressions))
        whole = (1, 1, len(plan.expressions))
        lines = (WRINKLES, WRINKLE_POINTS, 2)
        for name, size, chunk, kind, missing in (
            ("vertices", (*shape, plan.vertices, 3), (*whole, plan.vertices, 3), "float32", np.nan),
            ("wrinkles", shape + lines, whole + lines, "float32", np.nan),
            ("crossing", (*shape, 2), (*whole, 2), "int16", 0),
            ("sums", (plan.identities, _SUM), (1, _SUM), "uint8", 0),
        ):
            if not (path / name / "zarr.json").exists():  # nor are all there if a first build was killed at once
                packed = ZstdCodec(checksum=True)  # without it, a flipped bit is just another face
                with _writing(path):
                    group.create_array(
                        name, shape=size, chunks=chunk, dtype=kind, fill_value=missing, compressors=packed
                    )
        return cls.open(path)

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
        group, plan = _open(path)
        for name in ("vertices", "wrinkles", "crossing", "sums"):
            if not (path / name / "zarr.json").exists():
                raise ValueError(f"{path} lacks {name}: the command that began it goes on where it was")
            try:
                array = group[name]
                sound = isinstance(array, zarr.Array) and array.shape[0] == plan.identities
            except Exception as error:  # whatever zarr makes of a damaged description
                raise ValueError(f"{path / name / 'zarr.json'} is damaged: {_ANEW.format(path)}") from error
            if not sound:
                raise ValueError(f"{path / name} is of another number of identities: {_ANEW.format(path)}")
        return cls(path, group, plan)

    def require_frame(self, scale: float, origin: np.ndarray) -> None:
        """Keep where the source's heads stand, or see that they stand where they did when the database was begun.

        Raises
        ------
        ValueError
            If they do not: the source is another one, as a second folder of the same topology, or has changed.
        OSError
            If it cannot be written.
        """
        frame = [float(scale), *map(float, origin)]
        kept = self._group.attrs.get("frame")
        if kept is None:
            with _writing(self.path):
                self._group.attrs["frame"] = frame
        elif not np.allclose(np.array(kept, dtype=np.float64), frame, rtol=1e-5, atol=1e-5):
            raise ValueError(
                f"{self.path} was begun with other heads than those that the source {self.plan.source} gives now:"
                " name another folder or remove it"
            )

    def array(self, name: str) -> zarr.Array:
        """One of "vertices", "wrinkles", "crossing" and "sums"."""
        array = self._group[name]
        assert isinstance(array, zarr.Array)
        return array

    def write(self, number: int, heads: Heads) -> None:
        """Keep an identity; its sum comes last, so that one half written does not count.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        with _writing(self.path):
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
        return [number for number in range(self.plan.identities) if not self._is_whole(number)]

    def _is_whole(self, number: int) -> bool:
        try:
            kept = np.asarray(self.array("sums")[number])
            return bool(kept.any()) and bool((self.read(number).sum() == kept).all())
        except Exception:  # whatever a codec makes of damaged bytes
            return False

    def sum(self) -> str:
        """SHA-256 over all identities: the same for the same faces, whatever the order they were made in."""
        return hashlib.sha256(np.asarray(self.array("sums")[:]).tobytes()).hexdigest()


def _open(path: Path) -> tuple[zarr.Group, Plan]:
    """The group in a folder and its plan, whether or not all arrays are there; raises as `Store.open` does."""
    try:
        group = zarr.open_group(path, mode="r+")
    except (GroupNotFoundError, FileNotFoundError, FileExistsError, NotADirectoryError) as error:
        raise FileNotFoundError(
            f"{path} holds no face database: `sketchwidget database --out {path}` builds one"
        ) from error
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{path / 'zarr.json'} is damaged: {_ANEW.format(path)}") from error
    about: dict[str, Any] = dict(group.attrs)
    if about.get("format") != FORMAT:
        raise ValueError(f"{path} is no face database: its format is {about.get('format')!r}")
    if about.get("version") != VERSION:
        raise ValueError(
            f"{path} has version {about.get('version')!r} of the format, and this sketchwidget reads {VERSION}"
        )
    try:
        return group, Plan(**about["plan"] | {"expressions": tuple(about["plan"]["expressions"])})
    except (KeyError, TypeError) as error:
        raise ValueError(f"{path / 'zarr.json'} is damaged: {_ANEW.format(path)}") from error


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Say of what is not written where it should go, and that nothing is lost."""
    try:
        yield
    except OSError as error:
        raise OSError(
            f"{path} cannot be written: {error.strerror or error}; what is built stays, and the same command goes on"
        ) from error
