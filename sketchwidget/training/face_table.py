"""What training reads of each face: the points of its lines, its wrinkles, and its mesh in the model's components."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy import sparse
from tqdm import tqdm

from ..database.database import FaceDatabase
from ..face.exaggeration import LEVELS
from ..face.model import FaceModel
from ..face.template import PARTS
from ..face.wrinkles import LIPS
from ..files.kept import keep, kept
from ..sketch import FEATURES, SILHOUETTE

LINES = (SILHOUETTE, *FEATURES, *LIPS)

# Importance of the parts in the vertex loss (the weights of the paper's equation 2); lines count `_LINE_WEIGHT` times.
_PART_WEIGHTS = {"skin": 1.0, "mouth": 0.2, "eyes": 0.5, "teeth": 0.1, "tongue": 0.05}
_LINE_WEIGHT = 8.0


@dataclass(frozen=True)
class FaceTable:
    """Faces by person, one an identity and level, and by expression.

    Parameters
    ----------
    points : (i, e, p, 3) float16 array
        Of all lines of a face one after the other, millimetres.
    codes : (i, e, k) float32 array
        Coordinates of each mesh in the basis of the bilinear model.
    wrinkles : (j, e, w, m, 2) float16 array
        Suggestive contours of the first j people in the canonical front view, canvas units; NaN where there are no
        more. Nothing is known of those of others.
    lengths : dict of int
        Number of points of each line, in order.
    """

    points: np.ndarray
    codes: np.ndarray
    wrinkles: np.ndarray
    lengths: dict[str, int]

    def lines(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Points (p, d) as one array (n, d) a line."""
        pieces = np.split(points, self._ends)
        return dict(zip(self.lengths, pieces, strict=True))

    def joined(self, points: np.ndarray, codes: np.ndarray) -> FaceTable:
        """This table and, behind it, other people's points (i, e, p, 3) and codes (i, e, k)."""
        return replace(self, points=np.concatenate([self.points, points]), codes=np.concatenate([self.codes, codes]))

    @cached_property
    def _ends(self) -> np.ndarray:
        return np.cumsum(list(self.lengths.values()))[:-1]


def lines_of(model: FaceModel) -> sparse.csr_matrix:
    """Takes the coarse vertices (n, 3) of a face to the points (p, 3) of all its lines, one after the other."""
    return model.template.subdivision[np.concatenate([model.curves[name] for name in LINES])]


def tabulate(database: FaceDatabase, path: Path) -> FaceTable:
    """The table of a database, kept at `path` (.npz) once made."""
    model = database.model
    lengths = {name: len(model.curves[name]) for name in LINES}
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        pick = lines_of(model)
        points, codes, wrinkles = [], [], []
        for identity in tqdm(range(database.identities), desc="table", unit="head"):
            for level in range(1, LEVELS + 1):
                heads = database.person(identity, level)
                codes.append(model.bilinear.coordinates(heads.reshape(len(heads), -1)))
                points.append(np.stack([pick @ head for head in heads]).astype(np.float16))
                wrinkles.append(database.wrinkles_of(identity, level).astype(np.float16))
        most = max(int(np.isfinite(lines[..., 0, 0]).sum(axis=-1).max(initial=0)) for lines in wrinkles)
        wrinkles = np.stack([lines[:, :most] for lines in wrinkles])
        table = {"points": np.stack(points), "codes": np.stack(codes).astype(np.float32), "wrinkles": wrinkles}
        keep(path, table)
    return FaceTable(**kept(path, ("points", "codes", "wrinkles")), lengths=lengths)


def vertex_metric(model: FaceModel) -> np.ndarray:
    """Matrix (k, k) of the vertex loss (equation 2): codes that differ by d are ``d @ metric @ d`` mm^2 apart."""
    template, basis = model.template, model.bilinear.basis
    weights = np.array([_PART_WEIGHTS[part] for part in PARTS])[template.fine_parts]
    weights[np.unique(np.concatenate([model.curves[name] for name in LINES]))] *= _LINE_WEIGHT
    fine = template.subdivision
    gram = (fine.T @ sparse.diags(weights / weights.sum()) @ fine).tocsr()
    by_axis = basis.reshape(-1, 3, basis.shape[1])
    metric = np.sum([by_axis[:, axis].T @ (gram @ by_axis[:, axis]) for axis in range(3)], axis=0)
    return metric.astype(np.float32)
