"""The 2D bilinear model of lines, made from the faces of a table (paper 4.3)."""

from __future__ import annotations

import numpy as np

from ..face.decomposition import decompose
from ..face.drawing import outline
from ..geometry.view import View
from ..inference.framing import Frame
from ..inference.shape_code import ShapeModel, sample
from ..sketch import SILHOUETTE
from .face_table import FaceTable

_PEOPLE = 600  # as many as the paper's model has


def normalised(lines: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Projected lines (n, 2) of a face, the silhouette as it is drawn, in the frame of its outline."""
    drawn = lines | {SILHOUETTE: outline(lines[SILHOUETTE])}
    frame = Frame.of_outline(drawn[SILHOUETTE])
    return {name: frame(line) for name, line in drawn.items()}


def build_shape_model(table: FaceTable, people: np.ndarray, rank: tuple[int, int]) -> ShapeModel:
    """Decompose the lines of some people in all expressions.

    Parameters
    ----------
    table : FaceTable
    people : (m,) int array
        Rows of the table; of more than 600, as many spread over them.
    rank : (int, int)
        Identity and expression coefficients, (50, 16) in the paper.
    """
    chosen = people[np.unique(np.linspace(0, len(people) - 1, min(len(people), _PEOPLE)).astype(int))]
    view = View()
    tensor = np.stack(
        [
            [
                sample(normalised(table.lines(view.project(points.astype(np.float32))))).ravel()
                for points in table.points[person]
            ]
            for person in chosen
        ]
    ).astype(np.float32)
    held = (min(rank[0], tensor.shape[0]), min(rank[1], tensor.shape[1]))
    model = decompose(tensor, held, components=tensor.shape[2])
    # Of few people, what is left of the rank says nothing: networks expect all of it.
    more = [(0, wanted - size) for wanted, size in zip(rank, held, strict=True)]
    core = np.pad(np.einsum("dk,kpq->dpq", model.basis, model.core), [(0, 0), *more])
    identities = np.pad(model.identities, [(0, 0), more[0]])
    expressions = np.pad(model.expressions, [(0, 0), more[1]])
    return ShapeModel(
        mean=model.mean,
        core=core,
        identity_mean=identities.mean(axis=0),
        identity_std=identities.std(axis=0),
        expression_mean=expressions.mean(axis=0),
        expression_std=expressions.std(axis=0),
    )
