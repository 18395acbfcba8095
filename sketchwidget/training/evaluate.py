"""How far inferred heads are from the true ones, in millimetres: the rows of the paper's Table 2."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from ..face import Face
from ..face.model import FaceModel
from ..geometry.view import View
from ..inference.matching import DrawnLines, shape_code
from ..inference.refinement import LineRefiner, Match
from ..inference.regressor import BY_PIXELS, FaceRegressor
from ..inference.shape_code import split_lines
from ..sketch import SILHOUETTE, Sketch
from ..sketch.hand import PARTS, Hand
from .examples import Variety, noisy_view
from .face_table import LINES
from .manners import Drawn, Manner, draw
from .maps import skin_of
from .pipeline import Pipeline
from .standard import standardisation

_BATCH = 50
_PRIOR_ERRORS = (1.0, 1.0)  # of the morphable model's fit: the spread of the model's own weights
_FITTING_STEPS = 8

Weights = tuple[np.ndarray, np.ndarray]
Errors = dict[str, dict[str, np.ndarray]]  # mm at each vertex of the skin, by manner and by method
Method = Callable[["TestSet"], Weights]


@dataclass(frozen=True)
class TestSet:
    """Faces that networks did not train on, and one drawing of each.

    Parameters
    ----------
    faces : list of Face
    drawn : list of Drawn
    """

    faces: list[Face]
    drawn: list[Drawn]


def test_set(pipeline: Pipeline, split: str, manner: Manner, count: int) -> TestSet:
    """Faces of a split, drawn in a manner; the same arguments give the same drawings."""
    view, random = View(), np.random.default_rng(0)
    faces, drawn = [], []
    for face, wrinkles in pipeline.faces(split, count):
        seen_from = view if manner is Manner.EXACT else noisy_view(Variety().view, random)
        lines, front = ({name: of.project(face.curve(name)) for name in LINES} for of in (seen_from, view))
        drawn.append(draw(manner, lines, set(PARTS), wrinkles, front, Hand(), random))
        faces.append(face)
    return TestSet(faces, drawn)


test_set.__test__ = False  # not one of pytest's


def vertex_errors(faces: list[Face], weights: Weights | None) -> np.ndarray:
    """Distance in mm of each vertex of the skin (s,) from that of weights (m, p) and (m, q), mean over faces.

    Without weights, from that of the mean face.
    """
    model = faces[0].model
    skin = skin_of(model)
    total = np.zeros(int(skin.sum()))
    for number, face in enumerate(faces):
        found = model.mean if weights is None else model.vertices(weights[0][number], weights[1][number])
        total += np.linalg.norm(face.vertices[skin] - found[skin], axis=1)
    return total / len(faces)


def inferred(regressor: FaceRegressor, tests: TestSet, codes: np.ndarray | None = None) -> Weights:
    """Identity (m, p) and expression (m, q) weights of the drawings of a test set, from pixels and codes (m, c)."""
    parts = []
    for start in tqdm(range(0, len(tests.drawn), _BATCH), unit="batch", leave=False):
        batch = slice(start, start + _BATCH)
        images = np.stack([one.image for one in tests.drawn[batch]])
        parts.append(regressor.weights(images, None if codes is None else codes[batch]))
    identities, expressions = (np.concatenate(part) for part in zip(*parts, strict=True))
    return identities, expressions


def known(regressor: FaceRegressor, tests: TestSet) -> np.ndarray:
    """Codes (m, c) of the lines of a test set, of which each point is known."""
    assert regressor.shape_model is not None
    points, seen = np.stack([one.points for one in tests.drawn]), np.stack([one.seen for one in tests.drawn])
    return regressor.shape_model.describe(points, seen)


def found(regressor: FaceRegressor, refiner: LineRefiner, tests: TestSet) -> Weights:
    """Weights (m, p) and (m, q) as the Studio has them of a test set's strokes, whose names are known."""
    assert regressor.shape_model is not None
    alone = inferred(regressor, tests)
    codes = []
    for identity, expression, drawing in zip(*alone, tests.drawn, strict=True):
        drawn = DrawnLines.of_points(drawing.points, drawing.seen).without_ears()
        codes.append(shape_code(regressor.shape_model, refiner.framed(identity, expression), drawn))
    both = inferred(regressor, tests, np.stack(codes))
    identities, expressions = (BY_PIXELS * one + (1 - BY_PIXELS) * two for one, two in zip(alone, both, strict=True))
    return identities, expressions


def refined(refiner: LineRefiner, start: Weights, tests: TestSet) -> Weights:
    """Weights (m, p) and (m, q) moved by the lines of the drawings of a test set, whose names are known."""
    return _stacked(
        [
            refiner(identity, expression, DrawnLines.of_points(drawing.points, drawing.seen).without_ears().match)
            for identity, expression, drawing in zip(*start, tests.drawn, strict=True)
        ]
    )


def morphable_model_fit(model: FaceModel) -> Method:
    """What lines alone give under the prior of the model, whose points are known: the paper's MMfitting."""
    refiner = LineRefiner(model, standardisation(model), errors=_PRIOR_ERRORS, steps=_FITTING_STEPS, steady=False)
    middle = model.bilinear.expressions.mean(axis=0)

    def fitted(tests: TestSet) -> Weights:
        return _stacked([refiner(model.mean_identity, middle, _labelled(drawing)) for drawing in tests.drawn])

    return fitted


def _labelled(drawing: Drawn) -> Match:
    """The points of a drawing for those of a head's lines, each known; of the outline, along which they slide, the
    nearest.
    """
    outline = split_lines(np.arange(len(drawing.points)))[SILHOUETTE]
    seen = outline[drawing.seen[outline]]
    drawn = DrawnLines([drawing.points[seen]], [SILHOUETTE]) if len(seen) else None

    def match(points: np.ndarray, settled: bool) -> tuple[np.ndarray, np.ndarray]:
        target, weight = drawing.points.copy(), drawing.seen.astype(np.float64)
        if drawn is not None:
            nearest, near = drawn.match(points, settled)
            target[outline], weight[outline] = nearest[outline], near[outline]
        return target, weight

    return match


def _stacked(found: list[Weights]) -> Weights:
    return np.stack([identity for identity, _ in found]), np.stack([expression for _, expression in found])


def methods_of(name: str, regressor: FaceRegressor) -> dict[str, Method]:
    """The answers of a network: of its pixels, with the shape of the lines, and as the Studio has it.

    There it is not known which point of a line is which, pixels alone keep a share, and lines refine the answer.
    """
    title = Path(name).stem if Path(name).suffix else name
    refiner = LineRefiner(regressor.model, standardisation(regressor.model))
    methods: dict[str, Method] = {}
    if "pixels" in regressor.sees:
        methods[f"{title}, pixels alone" if "shape" in regressor.sees else title] = lambda tests: inferred(
            regressor, tests
        )
    if "shape" in regressor.sees:
        methods[title] = lambda tests: inferred(regressor, tests, known(regressor, tests))
        methods[f"{title}, refined by lines"] = lambda tests: refined(refiner, methods[title](tests), tests)
    if regressor.sees == ("pixels", "shape"):
        in_studio = f"{title} as in a Studio"
        methods[in_studio] = lambda tests: found(regressor, refiner, tests)
        methods[f"{in_studio}, refined by lines"] = lambda tests: refined(refiner, methods[in_studio](tests), tests)
    return methods


def compare(pipeline: Pipeline, methods: Mapping[str, Method], split: str, count: int) -> Errors:
    """Errors of the mean face, of the best fit that the model can hold, and of methods, by manner of drawing."""
    model = pipeline.database.model
    faces = [face for face, _ in pipeline.faces(split, count)]
    best = [model.fit(face.vertices) for face in tqdm(faces, desc=f"best fits, {split}", unit="face", leave=False)]
    references = {"mean face": vertex_errors(faces, None), "best fit in 3D": vertex_errors(faces, _stacked(best))}
    methods = {"MMfitting": morphable_model_fit(model), **methods}
    manners = {}
    for manner in Manner:
        tests = test_set(pipeline, split, manner, count)
        errors = {name: vertex_errors(faces, method(tests)) for name, method in methods.items()}
        manners[manner.value] = references | errors
    return manners


def with_and_without_wrinkles(
    pipeline: Pipeline, regressor: FaceRegressor, count: int, shown: int = 4
) -> list[tuple[Sketch, Face, Face]]:
    """Of some faces of people left out, those drawings that wrinkle lines change most, and the heads with and without.

    Parameters
    ----------
    pipeline : Pipeline
    regressor : FaceRegressor
    count : int
        Faces to look at.
    shown : int
        Of these.
    """
    found = []
    for number in pipeline.unseen("identity", count):
        face = pipeline.database[int(number)].face
        drawings = [face.sketch(wrinkles=wrinkles) for wrinkles in (True, False)]
        with_lines, without = (regressor.predict(drawing) for drawing in drawings)
        change = float(np.linalg.norm(with_lines.vertices - without.vertices, axis=1).mean())
        found.append((change, drawings[0], with_lines, without))
    found.sort(key=lambda one: -one[0])
    return [(drawing, with_lines, without) for _, drawing, with_lines, without in found[:shown]]
