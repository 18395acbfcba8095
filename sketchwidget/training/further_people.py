"""People whom a database does not hold, for networks to learn from: of each the lines and the faces, and nothing else.

What a network gets wrong of people whom it has never seen falls with the number of those it has, and a database's
wrinkles, contacts and meshes take three times as long to make as what is made here.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from joblib import delayed
from tqdm import tqdm

from ..database.build import Maker, in_processes, prepare
from ..database.database import FaceDatabase
from ..database.source import FaceSource
from ..face.model import FaceModel
from ..files.kept import keep, kept
from .face_table import FaceTable, lines_of

_TOGETHER = 20  # people of a file; those of a finished one are not made again


@dataclass(frozen=True)
class Further:
    """So many people more, from the first one on that a database does not have.

    Parameters
    ----------
    source : FaceSource
        Of the database's people.
    count : int
        How many people, each at all levels and in all expressions.
    jobs : int
        Processes that make them.
    """

    source: FaceSource
    count: int
    jobs: int = 1

    def __len__(self) -> int:
        return self.count

    def __post_init__(self) -> None:
        if self.count < 1:
            raise ValueError(f"further people are 1 or more; given {self.count}")

    def behind(self, table: FaceTable, database: FaceDatabase, folder: Path) -> FaceTable:
        """A database's table and, behind it, these people, made in a folder; what is there is not made again.

        Raises
        ------
        ValueError
            If the source has not so many people, or is another one than the database's.
        OSError
            If a process is killed.
        """
        source, first = self.source, database.identities
        if source.count is not None and first + self.count > source.count:
            raise ValueError(f"the source {source.name} has {source.count} people; {first + self.count} were asked for")
        folder.mkdir(parents=True, exist_ok=True)
        starts = range(first, first + self.count, _TOGETHER)
        parts = [range(start, min(start + _TOGETHER, first + self.count)) for start in starts]
        paths = [folder / f"{part[0]}-{part[-1]}.npz" for part in parts]
        missing = [(part, path) for part, path in zip(parts, paths, strict=True) if not path.exists()]
        if missing:
            maker = prepare(source, first)
            database.require_source(source, maker.scale, maker.origin)
            calls = (delayed(_make)(maker, database.model, part, path) for part, path in missing)
            made = in_processes(calls, self.jobs)
            for _ in tqdm(made, desc="further people", total=len(missing), unit=f"{_TOGETHER} people"):
                pass
        more = [kept(path, ("points", "codes")) for path in paths]
        return table.joined(*(np.concatenate([part[name] for part in more]) for name in ("points", "codes")))


def _make(maker: Maker, model: FaceModel, numbers: Iterable[int], path: Path) -> None:
    """Keep the lines and the codes of some people, whose teeth may come through their skin: no line shows them."""
    pick = lines_of(model)
    points, codes = [], []
    for number in numbers:
        for heads in maker.skin(number):
            points.append(np.stack([pick @ head for head in heads]).astype(np.float16))
            codes.append(model.bilinear.coordinates(heads.reshape(len(heads), -1)))
    keep(path, {"points": np.stack(points), "codes": np.stack(codes).astype(np.float32)})
