"""How far inferred heads are from the true ones, in millimetres."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

from ..face.bilinear import fit
from ..face.model import FaceModel
from ..face.template import PARTS as HEAD_PARTS
from ..inference.regressor import FaceRegressor
from ..sketch.hand import Hand
from .examples import PARTS, Variety, draw_example
from .face_table import FaceTable

CLEAN = Variety(view=0.0, hand=None)
AUGMENTED = Variety(view=2.5, hand=Hand(tremor=0.004, misplacement=0.004, shorthand=0.0, extras=0.1))
_MISSING = 0.1  # share of the parts that augmented drawings lack


@dataclass(frozen=True)
class UnseenFaces:
    """Faces with their true meshes, seen by neither model nor network or at least not by the network.

    Parameters
    ----------
    table : FaceTable
    heads : (i, e, n, 3) array
        Coarse vertices in the frame ``scale * (heads - origin)``.
    scale : float
    origin : (3,) array
    chosen : (m, 2) int array
        Identity and expression of each test face.
    """

    table: FaceTable
    heads: np.ndarray
    scale: float
    origin: np.ndarray
    chosen: np.ndarray


def vertex_errors(
    model: FaceModel,
    faces: UnseenFaces,
    predict: Callable[[int, int, np.ndarray], tuple[np.ndarray, np.ndarray] | None],
) -> np.ndarray:
    """Mean distance (m,), in mm, between true and predicted skin vertices of each test face.

    Parameters
    ----------
    model : FaceModel
    faces : UnseenFaces
    predict : callable
        From identity, expression and the true coarse mesh (n, 3) to weights u and v; None stands for the mean mesh.
    """
    skin = model.template.subdivision[model.template.fine_parts == HEAD_PARTS.index("skin")]
    errors = []
    for identity, expression in tqdm(faces.chosen, unit="face", leave=False):
        truth = faces.scale * (faces.heads[identity, expression] - faces.origin.astype(np.float32))
        weights = predict(identity, expression, truth)
        bilinear = model.bilinear
        code = 0 if weights is None else bilinear.basis @ (bilinear.core @ weights[1] @ weights[0])
        difference = truth - (bilinear.mean + code).reshape(-1, 3)
        errors.append(np.linalg.norm(skin @ difference, axis=1).mean())
    return np.array(errors)


def compare(regressor: FaceRegressor, faces: UnseenFaces, seed: int = 0) -> dict[str, float]:
    """Mean vertex error in mm of the mean face, of the best fit that the model can hold, and of the network.

    The network's on exact drawings ("clean") and on drawings with a noisy view, bent and missing lines ("augmented").
    """
    model = regressor.model

    def drawn(variety: Variety, missing: float) -> Callable[[int, int, np.ndarray], tuple[np.ndarray, np.ndarray]]:
        random = np.random.default_rng(seed)

        def predict(identity: int, expression: int, truth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            lines = faces.table.lines(faces.table.points[identity, expression].astype(np.float32))
            parts = {part for part in PARTS if part == "outline" or random.random() >= missing}
            identities, expressions = regressor.weights(draw_example(lines, parts, variety, random)[None])
            return identities[0], expressions[0]

        return predict

    methods = {
        "mean face": lambda identity, expression, truth: None,
        "best fit in 3D": lambda identity, expression, truth: fit(model.bilinear, truth.ravel()),
        "PixelCNN, clean": drawn(CLEAN, 0.0),
        "PixelCNN, augmented": drawn(AUGMENTED, _MISSING),
    }
    return {name: float(vertex_errors(model, faces, predict).mean()) for name, predict in methods.items()}
