"""Drawings that people made, as examples for training."""

from itertools import pairwise

import numpy as np
import pytest

from sketchwidget.database.drawings import Drawing
from sketchwidget.training import drawings
from sketchwidget.training.drawings import DrawnExamples
from sketchwidget.training.examples import Variety
from sketchwidget.training.standard import standardisation


@pytest.fixture
def unbent(monkeypatch):
    monkeypatch.setattr(drawings, "deform_lines", lambda sketch, random: sketch)


def drawn(face, view="front", scale=1.0, shift=0.0, more=()):
    """A face drawn exactly, moved on the canvas."""
    lines = [segment.points for segment in face.sketch().segments] + [np.array(line) for line in more]
    strokes = [
        np.column_stack([scale * points + shift, np.full(len(points), 0.5), 8.0 * np.arange(len(points))])
        for points in lines
    ]
    return Drawing.of(face, strokes, view)


def only(drawing, model, seed=0):
    """The example of a single drawing."""
    return DrawnExamples([drawing], model).example(np.random.default_rng(seed))


def test_the_code_of_an_example_is_the_head_in_the_basis_of_the_model(model):
    face = model.face(model.bilinear.identities[3], model.bilinear.expressions[2])
    _, code, _ = only(drawn(face), model)
    bilinear, subdivision = model.bilinear, model.template.subdivision
    head = subdivision @ (bilinear.mean + bilinear.basis @ code).reshape(-1, 3)
    np.testing.assert_allclose(head, face.vertices, atol=1e-3)


def test_the_pose_of_an_example_is_its_standardised_expression(model):
    statistics = standardisation(model)
    for expression in (2, 7):
        _, _, pose = only(drawn(model.face(expression=model.expressions[expression])), model)
        found = statistics["expression_mean"] + statistics["expression_std"] * pose
        np.testing.assert_allclose(found, model.bilinear.expressions[expression], atol=1e-5)


def test_an_image_does_not_depend_on_the_drawing_s_place_and_size(model, unbent):
    face = model.face()
    here, there = (only(drawing, model)[0].image for drawing in (drawn(face), drawn(face, scale=0.6, shift=0.1)))
    assert here.shape == (256, 256) and here.dtype == bool
    assert (here & there).sum() > 0.9 * here.sum()
    columns = np.flatnonzero(there.any(axis=0))
    assert abs(columns[0] + columns[-1] - 255) <= 3


def test_hair_is_left_out(model, unbent):
    hair = [[(0.45 + 0.02 * n, 0.01), (0.46 + 0.02 * n, 0.06)] for n in range(3)]
    bald, hairy = (only(drawn(model.face(), more=more), model)[0].image for more in ((), hair))
    np.testing.assert_array_equal(bald, hairy)


def test_a_drawing_is_bent_anew_each_time_and_a_little(model):
    examples = DrawnExamples([drawn(model.face())], model)
    random = np.random.default_rng(0)
    images = [examples.example(random)[0].image for _ in range(4)]
    assert all((one != other).any() for one, other in pairwise(images))
    np.testing.assert_array_equal(only(drawn(model.face()), model)[0].image, images[0])


def test_nobody_said_which_lines_are_drawn(model):
    example, _, _ = only(drawn(model.face()), model)
    assert not example.seen.any() and np.isfinite(example.points).all()
    assert example.points.shape == (*example.seen.shape, 2)


def test_side_views_are_left_out(model, unbent):
    other = model.face(model.bilinear.identities[0])
    examples = DrawnExamples([drawn(model.face()), drawn(model.face(), view="left"), drawn(other)], model)
    assert len(examples) == 2
    random = np.random.default_rng(1)
    codes = {tuple(np.round(examples.example(random)[1], 2)) for _ in range(20)}
    assert codes == {tuple(np.round(only(drawn(face), model)[1], 2)) for face in (model.face(), other)}


@pytest.mark.parametrize("views", [(), ("left",), ("left", "left")])
def test_without_a_drawing_of_the_front_there_are_no_examples(model, views):
    with pytest.raises(ValueError, match="none of the drawings shows the front"):
        DrawnExamples([drawn(model.face(), view=view) for view in views], model)


def test_drawings_of_another_model_are_refused(model):
    face = model.face()
    other = Drawing(drawn(face).strokes, face.identity, face.expression, "0" * 64)
    with pytest.raises(ValueError, match="drawing 1 was kept with the weights of another face model"):
        DrawnExamples([drawn(face), other], model)


def test_networks_and_drawings_name_a_model_alike(model):
    assert drawn(model.face()).model == model.fingerprint


def test_networks_train_on_drawings_too(pipeline):
    own = pipeline.database.model
    face = own.face(own.bilinear.identities[2], "laugh")
    people = DrawnExamples([drawn(face)], own)
    _, shapes, codes, poses, _ = pipeline.examples(Variety(people=1.0), 3, people).numbered(0)
    np.testing.assert_allclose(codes, np.tile(only(drawn(face), own)[1], (3, 1)), atol=1e-4)
    assert not shapes[:, : pipeline.shape_model.size].any() and poses.shape == (3, own.expression_size)
