"""People whom a database does not hold, for networks to learn from: of each the lines and the faces, and nothing else.

What a network gets wrong of people whom it has never seen falls with the number of those it has, and a database's
wrinkles, contacts and meshes take three times as long to make as what is made here.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from tqdm import tqdm

from ..database.build import Maker, prepare
from ..database.source import FaceSource
from ..face.exaggeration import LEVELS
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

    def behind(self, table: FaceTable, model: FaceModel, folder: Path) -> FaceTable:
        """A database's table and, behind it, these people, made in a folder; what is there is not made again.

        Raises
        ------
        ValueError
            If the source has not so many people.
        """
        return table.joined(*_made(self, len(table.codes) // LEVELS, model, folder))


def _made(further: Further, first: int, model: FaceModel, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Points (i, e, p, 3) and codes (i, e, k) of the people from the first one on."""
    source, count = further.source, further.count
    if source.count is not None and first + count > source.count:
        raise ValueError(f"the source {source.name} has {source.count} people; {first + count} were asked for")
    folder.mkdir(parents=True, exist_ok=True)
    numbers = np.arange(first, first + count)
    parts = {
        folder / f"{part[0]}-{part[-1]}.npz": part for part in np.split(numbers, np.arange(_TOGETHER, count, _TOGETHER))
    }
    missing = {path: part for path, part in parts.items() if not path.exists()}
    if missing:
        maker = prepare(source, first)
        made: Any = Parallel(n_jobs=further.jobs, return_as="generator_unordered")(
            delayed(_make)(maker, model, part, path) for path, part in missing.items()
        )
        for _ in tqdm(made, desc="further people", total=len(missing), unit=f"{_TOGETHER} people"):
            pass
    more = [kept(path, ("points", "codes")) for path in parts]
    return np.concatenate([part["points"] for part in more]), np.concatenate([part["codes"] for part in more])


def _make(maker: Maker, model: FaceModel, numbers: Iterable[int], path: Path) -> None:
    pick = lines_of(model)
    points, codes = [], []
    for number in numbers:
        for heads in maker.skin(int(number)):
            points.append(np.stack([pick @ head for head in heads]).astype(np.float16))
            codes.append(model.bilinear.coordinates(heads.reshape(len(heads), -1)))
    keep(path, {"points": np.stack(points), "codes": np.stack(codes).astype(np.float32)})
