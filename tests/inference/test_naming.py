"""Names of freehand strokes, and the closed figures among them."""

import tracemalloc

import numpy as np
import pytest

from sketchwidget import FaceModel, Sketch
from sketchwidget.geometry import View
from sketchwidget.inference.figures import closed_figures, extents
from sketchwidget.inference.naming import whereabouts
from sketchwidget.inference.outline import find_outline
from sketchwidget.sketch import WRINKLE, resample_each

TURN = np.linspace(0, 2 * np.pi, 40)
CIRCLE = np.stack([np.cos(TURN), np.sin(TURN)], axis=1)


def names_of(regressor, strokes):
    return regressor.infer(Sketch.from_strokes(strokes)).names


def test_a_figure_is_closed_if_none_of_its_strokes_has_a_loose_end():
    square = np.array([[[0, 0], [1, 0]], [[1.1, 0], [1, 1]], [[0, 1], [1, 1.1]], [[0, 0.9], [0, 0.1]]])
    tail, chain = np.array([[[1.1, 1.1], [2, 2]]]), np.array([[[3, 3], [4, 3]], [[4, 3], [5, 3]]])
    strokes = [*square, *tail, *chain, CIRCLE + 6.0]
    found = closed_figures(dict(enumerate(extents(resample_each(strokes, 24)))), reach=0.2)
    assert sorted(map(sorted, found)) == [[0, 1, 2, 3], [7]]


def test_two_nostrils_are_a_nose(regressor, drawing):
    nostrils = [[x, 0.6] + 0.008 * CIRCLE for x in (0.475, 0.525)]
    assert names_of(regressor, [*drawing[:3], drawing[4], *nostrils])[-2:] == ("nose", "nose")


def test_freckles_are_no_nose(regressor, drawing):
    freckles = [np.array([[0.5 + x, 0.57 + y]]) for x in (-0.02, 0.02) for y in (0.0, 0.03)]
    assert names_of(regressor, [*drawing[:3], drawing[4], *freckles])[-4:] == (WRINKLE,) * 4


@pytest.mark.parametrize("place", [[0.4, 0.45], [0.5, 0.72]])
def test_dense_hatching_is_named_in_little_memory(regressor, drawing, place):
    lines = np.random.default_rng(0).normal(place, 0.01, (3000, 1, 2)) + np.array([[-0.01, 0.0], [0.01, 0.002]])
    tracemalloc.start()
    names = names_of(regressor, [*drawing, *lines])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(names) == len(drawing) + 3000 and peak < 150e6


def test_an_ear_is_as_far_from_a_narrow_outline_as_from_a_broad_one():
    narrow = [0.5, 0.5] + CIRCLE * [0.2, 0.38]
    ear = np.array([[0.25, 0.44], [0.22, 0.43], [0.21, 0.5], [0.23, 0.57], [0.255, 0.58]]) - [0.025, 0.0]
    assert whereabouts([narrow, ear, ear - [0.05, 0.0]], find_outline([narrow])) == ["inside", "ear", "outside"]


def test_lids_in_pieces_are_eyes_and_brows_in_pieces_are_brows(regressor):
    model = FaceModel.load()
    sketch = model.face(expression="surprise").sketch(wrinkles=False)
    true = [segment.name for segment in sketch.segments]
    given = names_of(regressor, [segment.points for segment in sketch.segments])
    for part in ("left_eye", "right_eye", "left_brow", "right_brow"):
        assert {new.startswith(part) for new, name in zip(given, true, strict=True) if name.startswith(part)} == {True}


def test_folds_beside_the_nose_and_below_the_eyes_are_no_eyes(regressor, drawing):
    fold = np.array([[0.45, 0.42], [0.455, 0.46], [0.445, 0.5]])
    bag = np.array([[0.36, 0.495], [0.39, 0.505], [0.42, 0.495]])
    folds = [fold, [1, 0] + fold * [-1, 1], bag, [1, 0] + bag * [-1, 1]]
    assert not any("eye" in name or "brow" in name for name in names_of(regressor, [*drawing, *folds])[5:])


@pytest.mark.parametrize("expression", ["neutral", "smile", "mouth_open"])
def test_lips_about_a_mouth_are_wrinkles(regressor, expression):
    face = FaceModel.load().face(expression=expression)
    lines = {name: View().project(face.curve(name)) for name in face.model.curves if "mouth" in name or "lip" in name}
    strokes = [segment.points for segment in face.sketch(wrinkles=False).segments if "mouth" not in segment.name]
    given = names_of(regressor, [*strokes, *lines.values()])[len(strokes) :]
    assert {name: new == "wrinkle" for name, new in zip(lines, given, strict=True)} == {
        name: "lip" in name for name in lines
    }


def test_teeth_are_no_mouth(regressor, drawing):
    across, hang = np.linspace(-1, 1, 20), 1 - np.linspace(-1, 1, 20) ** 2
    upper, teeth, lower = (
        np.stack([0.5 + width * across, 0.7 + drop * hang], axis=1)
        for width, drop in ((0.1, 0.0), (0.09, 0.03), (0.1, 0.09))
    )
    given = names_of(regressor, [*drawing[:4], upper, lower, teeth])[4:]
    assert given[0].startswith("mouth") and given[1].startswith("mouth") and given[2] == "wrinkle"
