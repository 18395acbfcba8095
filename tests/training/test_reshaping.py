"""Heads of other proportions."""

import numpy as np
import pytest

from sketchwidget.training.face_table import LINES
from sketchwidget.training.reshaping import Reshaping


@pytest.fixture(scope="module")
def code(model):
    """Of the mean face."""
    return model.bilinear.core @ model.face().expression @ model.mean_identity


@pytest.fixture(scope="module")
def reshaping(model):
    return Reshaping(model)


def points_of(model, code):
    """Points (p, 3) of the lines of a head."""
    fine = model.template.subdivision @ (model.bilinear.mean + model.bilinear.basis @ code).reshape(-1, 3)
    return fine[np.concatenate([model.curves[name] for name in LINES])]


@pytest.mark.parametrize("way", ["width", "height", "jaw", "crown"])
def test_the_mesh_is_reshaped_as_its_points_are(model, reshaping, code, way):
    before = points_of(model, code)
    points, reshaped = reshaping(before, code, {way: 0.15})
    assert np.abs(points_of(model, reshaped) - points).mean() < 1.5  # mm: what the vertex basis can hold of it
    axis = 1 if way == "height" else 0
    low, high = before[:, 1].min(), before[:, 1].max()
    part = {"jaw": before[:, 1] < low + 50, "crown": before[:, 1] > high - 50}.get(way, np.ones(len(before), bool))
    grown = np.ptp(points[part, axis]) / np.ptp(before[part, axis])
    assert grown == pytest.approx(1.15, abs=0.07)
    np.testing.assert_array_equal(np.delete(points, axis, axis=1), np.delete(before, axis, axis=1))


def test_an_amount_of_nothing_changes_nothing(model, reshaping, code):
    before = points_of(model, code)
    points, reshaped = reshaping(before, code, dict.fromkeys(("width", "height", "jaw", "crown"), 0.0))
    np.testing.assert_array_equal(points, before)
    np.testing.assert_array_equal(reshaped, code)


def test_what_is_given_stays_as_it_is(model, reshaping, code):
    points, before = points_of(model, code), code.copy()
    kept = points.copy()
    reshaping(points, code, {"width": 0.2, "jaw": -0.1})
    np.testing.assert_array_equal(points, kept)
    np.testing.assert_array_equal(code, before)
