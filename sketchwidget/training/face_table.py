"""What training reads of each face: the points of its lines, and its mesh in the vertex components of the model."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import sparse
from tqdm import tqdm

from ..face.drawing import LIPS
from ..face.model import FaceModel
from ..face.template import PARTS
from ..sketch import FEATURES, SILHOUETTE

LINES = (SILHOUETTE, *FEATURES, *LIPS)

# Importance of the parts in the vertex loss (the weights of the paper's equation 2); lines count `_LINE_WEIGHT` times.
_PART_WEIGHTS = {"skin": 1.0, "mouth": 0.2, "eyes": 0.5, "teeth": 0.1, "tongue": 0.05}
_LINE_WEIGHT = 8.0


@dataclass(frozen=True)
class FaceTable:
    """Faces by identity and expression.

    Parameters
    ----------
    points : (i, e, p, 3) float16 array
        Of all lines of a face one after the other, millimetres.
    codes : (i, e, k) float32 array
        Coordinates of each mesh in the basis of the bilinear model.
    lengths : dict of int
        Number of points of each line, in order.
    """

    points: np.ndarray
    codes: np.ndarray
    lengths: dict[str, int]

    def lines(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Points (p, d) as one array (n, d) a line."""
        pieces = np.split(points, np.cumsum(list(self.lengths.values()))[:-1])
        return dict(zip(self.lengths, pieces, strict=True))

    def first(self, count: int) -> FaceTable:
        """The table of the first identities only."""
        return FaceTable(self.points[:count], self.codes[:count], self.lengths)


def tabulate(model: FaceModel, heads: np.ndarray, scale: float, origin: np.ndarray, path: Path) -> FaceTable:
    """The table of posed heads (i, e, n, 3), kept at `path` (.npz) once made.

    Parameters
    ----------
    model : FaceModel
    heads : (i, e, n, 3) array
        Coarse vertices.
    scale : float
    origin : (3,) array
        ``scale * (heads - origin)`` has the frame of the model.
    path : Path
    """
    lengths = {name: len(model.curves[name]) for name in LINES}
    if not path.exists():
        pick = model.template.subdivision[np.concatenate([model.curves[name] for name in LINES])]
        points = np.empty((*heads.shape[:2], pick.shape[0], 3), dtype=np.float16)
        codes = np.empty((*heads.shape[:2], model.bilinear.basis.shape[1]), dtype=np.float32)
        for row in tqdm(range(len(heads)), desc="table", unit="head"):
            posed = scale * (heads[row] - origin.astype(np.float32))
            codes[row] = (posed.reshape(len(posed), -1) - model.bilinear.mean) @ model.bilinear.basis
            points[row] = np.stack([pick @ head for head in posed])
        unfinished = path.with_suffix(".part.npz")
        np.savez(unfinished, points=points, codes=codes)
        unfinished.rename(path)
    with np.load(path) as stored:
        return FaceTable(stored["points"], stored["codes"], lengths)


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


class Stretch:
    """Makes a head broader and shorter, or narrower and longer, in its points and its code alike.

    Parameters
    ----------
    model : FaceModel
    """

    def __init__(self, model: FaceModel) -> None:
        basis, mean = model.bilinear.basis, model.bilinear.mean
        # What scaling one axis about the origin adds to a code, for a unit of scale: an affine map of the code.
        self._linear = [basis[axis::3].T @ basis[axis::3] for axis in (0, 1)]
        self._constant = [basis[axis::3].T @ mean[axis::3] for axis in (0, 1)]

    def __call__(self, points: np.ndarray, code: np.ndarray, ratio: float) -> tuple[np.ndarray, np.ndarray]:
        """Points (p, 3) and code (k,) with width over height multiplied by `ratio`, the area kept."""
        factors = (ratio**0.5, ratio**-0.5)
        stretched = code + sum(
            (factor - 1) * (linear @ code + constant)
            for factor, linear, constant in zip(factors, self._linear, self._constant, strict=True)
        )
        return points * np.array([*factors, 1.0], dtype=np.float32), stretched
