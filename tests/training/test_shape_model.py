"""The 2D bilinear model of the lines of many faces."""

import numpy as np
import pytest

from sketchwidget.geometry import View
from sketchwidget.inference.framing import OUTLINE_SIZE
from sketchwidget.inference.shape_code import DETAILS, sample
from sketchwidget.sketch import SILHOUETTE
from sketchwidget.training import shape_model
from sketchwidget.training.examples import Variety
from sketchwidget.training.manners import Manner
from sketchwidget.training.shape_model import build_shape_model, normalised


def lines_of(table, row, expression):
    return table.lines(View().project(table.points[row, expression].astype(np.float32)))


def test_lines_are_normalised_by_their_outline(pipeline):
    lines = lines_of(pipeline.table, 3, 1)
    framed = normalised(lines)
    assert list(framed) == list(lines) and len(framed[SILHOUETTE]) == 180
    low, high = framed[SILHOUETTE].min(axis=0), framed[SILHOUETTE].max(axis=0)
    np.testing.assert_allclose((low + high) / 2, 0.5, atol=1e-5)
    assert np.sqrt(np.prod(high - low)) == pytest.approx(OUTLINE_SIZE, abs=1e-5)
    scale = np.ptp(framed["nose"][:, 0]) / np.ptp(lines["nose"][:, 0])
    np.testing.assert_allclose(np.diff(framed["nose"], axis=0), scale * np.diff(lines["nose"], axis=0), atol=1e-5)


def test_place_and_size_of_a_face_do_not_matter(pipeline):
    lines = lines_of(pipeline.table, 0, 2)
    moved = normalised({name: 0.7 * line + [0.1, 0.2] for name, line in lines.items()})
    for name, line in normalised(lines).items():
        np.testing.assert_allclose(moved[name], line, atol=1e-5)


def test_the_model_holds_the_faces_that_it_is_made_of(pipeline):
    table = pipeline.table
    model = build_shape_model(table, np.arange(12), (12, 3))
    points = np.stack([sample(normalised(lines_of(table, row, e))) for row in range(12) for e in range(3)])
    found = model.decode(model.encode(points, np.ones(points.shape[:2])))
    assert np.linalg.norm(found - points, axis=2).mean() < 0.003
    assert np.linalg.norm(model.mean.reshape(-1, 2) - points, axis=2).mean() > 0.006


def test_coefficients_are_standardised_over_people_and_expressions(pipeline):
    model = build_shape_model(pipeline.table, np.arange(12), (12, 3))
    # Singular vectors have unit length: what of it is no mean is spread.
    np.testing.assert_allclose(model.identity_mean**2 + model.identity_std**2, 1 / 12, atol=1e-4)
    np.testing.assert_allclose(model.expression_mean**2 + model.expression_std**2, 1 / 3, atol=1e-4)


def test_what_few_people_leave_of_the_rank_is_empty(pipeline):
    model = build_shape_model(pipeline.table, np.array([0, 5, 7]), (50, 16))
    assert model.core.shape == (384, 50, 16) and model.size == 66
    assert model.core[:, :3, :3].any() and not model.core[:, 3:].any() and not model.core[:, :, 3:].any()
    code = model.encode(model.decode(np.zeros((1, 66), dtype=np.float32)), np.ones((1, 192)))
    np.testing.assert_allclose(code, 0, atol=1e-3)
    assert build_shape_model(pipeline.table, np.arange(12), (2, 1)).core.shape == (384, 2, 1)


def test_of_too_many_people_some_are_chosen_from_all_over(pipeline, monkeypatch):
    monkeypatch.setattr(shape_model, "_PEOPLE", 3)
    model = build_shape_model(pipeline.table, np.arange(11), (50, 3))
    chosen = build_shape_model(pipeline.table, np.array([0, 5, 10]), (50, 3))
    np.testing.assert_array_equal(model.core, chosen.core)


def test_details_have_unit_spread_over_drawings_and_are_trusted_by_shares(pipeline):
    model = build_shape_model(pipeline.table, np.arange(12), (12, 3))
    variety = Variety(manners={Manner.EXACT: 0.4, Manner.AUGMENTED: 0.6}, of_model=0.0, mixed=0.0, blended=0.0)
    examples, random = pipeline.examples(variety, 1, pixels=False), np.random.default_rng(0)
    drawn = [examples.example(random)[0] for _ in range(400)]
    details = model.details(np.stack([one.points for one in drawn]), np.stack([one.seen for one in drawn]))
    told = np.abs(model.detail_axes).max(axis=0) > 0
    assert details.shape == (400, DETAILS) and not details[:, ~told].any()
    # Of few people the finest directions, which come first, are those of single drawings.
    coarse = details[:, told][:, told.sum() // 2 :]
    assert 0.7 < np.median(coarse.std(axis=0)) < 1.4
    assert model.detail_trust.shape == (DETAILS,) and not model.detail_trust[~told].any()
    assert ((model.detail_trust >= 0) & (model.detail_trust <= 1)).all() and 0.05 < model.detail_trust[told].mean() < 1
    np.testing.assert_array_equal(model.detail_axes, model.detail_axes.astype(np.float16))
