"""Drawings that people made, as pairs of an image and a code."""

import numpy as np
import pytest

from sketchwidget import FaceModel
from sketchwidget.database.drawings import Drawing
from sketchwidget.training.drawings import drawn_examples


@pytest.fixture(scope="module")
def model():
    return FaceModel.load()


def drawn(face, view="front", scale=1.0, shift=0.0, more=()):
    """A face drawn exactly, moved on the canvas."""
    lines = [segment.points for segment in face.sketch().segments] + [np.array(line) for line in more]
    strokes = [
        np.column_stack([scale * points + shift, np.full(len(points), 0.5), 8.0 * np.arange(len(points))])
        for points in lines
    ]
    return Drawing.of(face, strokes, view)


def test_the_code_of_an_example_is_the_head_in_the_basis_of_the_model(model):
    face = model.face(model.bilinear.identities[3], model.bilinear.expressions[2])
    _, codes, _ = drawn_examples([drawn(face)], model)
    bilinear, subdivision = model.bilinear, model.template.subdivision
    head = subdivision @ (bilinear.mean + bilinear.basis @ codes[0]).reshape(-1, 3)
    np.testing.assert_allclose(head, face.vertices, atol=1e-3)


def test_an_image_does_not_depend_on_the_drawing_s_place_and_size(model):
    face = model.face()
    images, _, _ = drawn_examples([drawn(face), drawn(face, scale=0.6, shift=0.1)], model)
    assert images.shape == (2, 256, 256) and images.dtype == bool
    assert (images[0] & images[1]).sum() > 0.9 * images[0].sum()
    columns = np.flatnonzero(images[1].any(axis=0))
    assert abs(columns[0] + columns[-1] - 255) <= 3


def test_hair_is_left_out(model):
    hair = [[(0.45 + 0.02 * n, 0.01), (0.46 + 0.02 * n, 0.06)] for n in range(3)]
    images, _, _ = drawn_examples([drawn(model.face()), drawn(model.face(), more=hair)], model)
    np.testing.assert_array_equal(images[0], images[1])


def test_side_views_are_left_out_and_counted(model):
    other = model.face(model.bilinear.identities[0])
    images, codes, left_out = drawn_examples(
        [drawn(model.face()), drawn(model.face(), view="left"), drawn(other)], model
    )
    assert (len(images), len(codes), left_out) == (2, 2, 1)
    np.testing.assert_array_equal(codes[1], drawn_examples([drawn(other)], model)[1][0])


def test_no_drawings_are_no_examples(model):
    images, codes, left_out = drawn_examples([], model)
    assert images.shape == (0, 256, 256) and codes.shape == (0, len(model.bilinear.core)) and left_out == 0


def test_drawings_of_another_model_are_refused(model):
    face = model.face()
    other = Drawing(drawn(face).strokes, face.identity, face.expression, "0" * 64)
    with pytest.raises(ValueError, match="drawing 1 was kept with the weights of another face model"):
        drawn_examples([drawn(face), other], model)


def test_networks_and_drawings_name_a_model_alike(model):
    assert drawn(model.face()).model == model.fingerprint
