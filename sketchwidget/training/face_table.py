"""What training reads of each face: the points of its lines, and its mesh in the vertex components of the model."""

from __future__ import annotations

from collections.abc import Mapping
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


class Reshaping:
    """Makes heads broader and longer, with broader and narrower jaws and crowns, in their points and their codes alike.

    People draw outlines that are rounder, squarer and more pointed than most heads are.

    Parameters
    ----------
    model : FaceModel
    """

    def __init__(self, model: FaceModel) -> None:
        basis, mean = model.bilinear.basis, model.bilinear.mean
        x, y, _ = mean.reshape(-1, 3).T
        lines = model.template.subdivision[np.concatenate([model.curves[name] for name in LINES])]
        everywhere, sides = np.ones_like(x), _rise(np.abs(x), 20.0, 55.0)
        # Axis and, for each coarse vertex, how much it takes part.
        ways = {
            "width": (0, everywhere),
            "height": (1, everywhere),
            "jaw": (0, sides * _rise(-y, 10.0, 75.0)),
            "crown": (0, sides * _rise(y, 10.0, 75.0)),
        }
        # Scaling an axis about the origin is an affine map of the code: by a matrix and a constant for a unit of scale.
        self._ways = {
            name: (
                axis,
                lines @ share,
                basis[axis::3].T @ (share[:, None] * basis[axis::3]),
                basis[axis::3].T @ (share * mean[axis::3]),
            )
            for name, (axis, share) in ways.items()
        }

    def __call__(
        self, points: np.ndarray, code: np.ndarray, amounts: Mapping[str, float]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Points (p, 3) and code (k,) reshaped one way after the other.

        Parameters
        ----------
        points : (p, 3) array
        code : (k,) array
        amounts : mapping of float
            By "width", "height", "jaw" and "crown": 0.1 makes that tenth larger.
        """
        points = points.copy()
        for name, amount in amounts.items():
            axis, share, linear, constant = self._ways[name]
            points[:, axis] *= 1 + amount * share
            code = code + amount * (linear @ code + constant)
        return points, code


def _rise(values: np.ndarray, low: float, high: float) -> np.ndarray:
    """0 up to `low`, 1 from `high` on, smooth between."""
    share = np.clip((values - low) / (high - low), 0.0, 1.0)
    return (share**2 * (3 - 2 * share)).astype(np.float32)
