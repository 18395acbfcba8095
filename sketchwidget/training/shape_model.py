"""The 2D bilinear model of lines, made from the faces of a table (paper 4.3), and how their points differ beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..face.decomposition import decompose
from ..face.drawing import outline
from ..geometry.view import View
from ..inference.framing import Frame
from ..inference.shape_code import DETAILS, ShapeModel, sample, weighted
from ..sketch import SILHOUETTE
from ..sketch.hand import Hand
from .examples import Variety, found_shape, noisy_view
from .face_table import FaceTable
from .manners import Manner, draw

_PEOPLE = 600  # as many as the paper's model has
_DRAWINGS, _OF_EACH = 6_000, 20  # that details are learnt from, at most: in all, and of each face
_EXACT = 0.4  # share of them; the others are augmented
_FOUND = 1_000  # of them whose points are found too
_FINEST = 0.01  # of the drawing noise: drawings that differ by less are alike


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
    points, seen = _drawings(table, chosen)
    detail_mean, detail_axes = _details(weighted(model.mean, points, seen))
    made = ShapeModel(
        mean=model.mean,
        core=core,
        identity_mean=identities.mean(axis=0),
        identity_std=identities.std(axis=0),
        expression_mean=expressions.mean(axis=0),
        expression_std=expressions.std(axis=0),
        detail_mean=detail_mean,
        detail_axes=detail_axes,
        detail_trust=np.ones(DETAILS, np.float32),
    )
    return replace(made, detail_trust=_trust(made, points[:_FOUND], seen[:_FOUND]))


def _drawings(table: FaceTable, people: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (b, n, 2) of drawings of people, exact and augmented, and which (b, n) of them are seen."""
    random, front = np.random.default_rng(0), View()
    expressions = table.codes.shape[1]
    drawn = []
    for _ in range(min(_DRAWINGS, _OF_EACH * len(people) * expressions)):
        face = table.points[random.choice(people), random.integers(expressions)].astype(np.float32)
        manner = Manner.EXACT if random.random() < _EXACT else Manner.AUGMENTED
        view = front if manner is Manner.EXACT else noisy_view(Variety().view, random)
        lines = table.lines(view.project(face))
        drawn.append(draw(manner, lines, set(), None, lines, Hand(), random, pixels=False))
    return np.stack([one.points for one in drawn]), np.stack([one.seen for one in drawn])


def _details(samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean (3 n,) and principal directions (3 n, r), each over its spread, of `weighted` points (b, 3 n).

    In half precision, as files keep them: a network learns by those that it will be used with.
    """
    middle = samples.mean(axis=0)
    variances, directions = np.linalg.eigh(np.cov((samples - middle).T.astype(np.float64)))
    told = np.flatnonzero(variances > _FINEST**2)[-DETAILS:]
    axes = np.zeros((samples.shape[1], DETAILS), np.float16)
    axes[:, : len(told)] = directions[:, told] / np.sqrt(variances[told])
    return middle, axes.astype(np.float32)


def _trust(model: ShapeModel, points: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Shares (r,) of details that are true where points are found: by least squares, those of what they would be."""
    random = np.random.default_rng(1)
    known = model.describe(points, seen)
    drawings = zip(known[:, : model.size], points, seen, strict=True)
    found = np.stack([found_shape(model, *drawing, random) for drawing in drawings])
    details, true = (shapes[:, model.size : -1] for shapes in (found, known))
    common = ((details - details.mean(axis=0)) * (true - true.mean(axis=0))).mean(axis=0)
    return np.clip(common / np.maximum(details.var(axis=0), 1e-6), 0.0, 1.0).astype(np.float32)
