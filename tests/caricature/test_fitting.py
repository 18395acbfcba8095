import os
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sketchwidget as sw
from sketchwidget.caricature import fit
from sketchwidget.geometry.alignment import similarity
from sketchwidget.geometry.regularity import folded

EYES = (36, 45)
PUBLISHED = Path(os.environ.get("SKETCHWIDGET_CARICATURES", "not there"))


def eye_distance(landmarks):
    return np.linalg.norm(landmarks[EYES[0]] - landmarks[EYES[1]])


def test_a_caricature_is_met_at_its_landmarks(fitted, drawn):
    found, _ = fitted
    assert found.rmse < 0.02 * eye_distance(drawn[1])
    assert found.rmse == pytest.approx(np.sqrt((found.errors**2).mean()))
    np.testing.assert_allclose(np.linalg.norm(found.project() - drawn[1], axis=1), found.errors)


def test_the_head_is_nearer_to_the_one_that_was_drawn_than_the_mean_face_is(fitted, drawn, model):
    """From the front, where the landmarks tell it: depth is the basis's guess."""

    def distance(vertices):
        face = model.landmarks
        scale, rotation, offset = similarity(vertices[face], drawn[0].vertices[face])
        missed = scale * vertices[face] @ rotation.T + offset - drawn[0].vertices[face]
        return np.linalg.norm(missed[:, :2], axis=1).mean()

    assert distance(fitted[0].vertices) < 0.9 * distance(model.mean)


def test_the_camera_is_found(fitted, camera):
    turn = Rotation.from_matrix(fitted[0].rotation @ camera.rotation.T)
    assert np.degrees(turn.magnitude()) < 15
    assert fitted[0].scale == pytest.approx(camera.scale, rel=0.25)


def test_fields_are_as_they_are_named(fitted, model):
    found, _ = fitted
    assert found.vertices.shape == model.mean.shape and np.isfinite(found.vertices).all()
    assert found.landmark_vertices.shape == (68,)
    np.testing.assert_array_equal(found.landmark_vertices[17:], model.landmarks[17:])
    points = found.vertices[found.landmark_vertices]
    by_hand = found.scale * (points @ found.rotation.T)[:, :2] * (1, -1) + found.translation
    np.testing.assert_allclose(found.project(), by_hand, atol=1e-3)
    assert found.camera.scale == found.scale and found.weights.shape == (2, len(found.examples))
    np.testing.assert_array_equal(found.face.vertices, found.vertices)


def test_the_energy_falls_and_progress_tells_it(fitted):
    found, steps = fitted
    assert [step.iteration for step in steps] == [1, 2, 3, 4, 5, 6]
    assert tuple(step.energy for step in steps) == found.energies
    assert found.energies[-1] < found.energies[0] and min(found.energies) > 0
    assert steps[0].vertices.shape == found.vertices.shape


def test_the_head_stays_a_surface(fitted, model):
    skin = model.template.fine_parts == 0
    faces = model.faces[skin[model.faces].all(axis=1)]
    folds = folded(fitted[0].vertices, faces) & ~folded(model.mean, faces)
    assert folds.mean() < 0.002


@pytest.mark.parametrize("scale", [0.01, 30.0])
def test_size_and_place_of_the_picture_do_not_matter(fitted, drawn, model, scale):
    moved = fit(drawn[1] * scale + [70, -900], model=model)
    np.testing.assert_allclose(moved.vertices, fitted[0].vertices, atol=0.5)
    assert moved.scale == pytest.approx(scale * fitted[0].scale, rel=0.01)


def test_a_landmark_of_weight_0_takes_no_part(drawn, model):
    weights = np.ones(68)
    weights[[3, 8, 30, 50]] = 0
    wrong = drawn[1].copy()
    wrong[weights == 0] += [500.0, -300.0]
    with_truth, with_lies = (fit(each, weights, model, iterations=2) for each in (drawn[1], wrong))
    inner = np.array([30, 50])
    np.testing.assert_allclose(with_lies.vertices, with_truth.vertices, atol=1e-3)
    assert (with_lies.errors[inner] > 100).all() and with_lies.rmse < 10


def test_weights_count(drawn, model):
    pulled = drawn[1].copy()
    pulled[30] += [0.0, 12.0]
    weights = np.ones(68)
    weights[30] = 20
    light, heavy = (fit(pulled, each, model, iterations=2).errors[30] for each in (None, weights))
    assert heavy < 0.5 * light


@pytest.mark.parametrize("times", [1e-6, 1e6])
def test_only_ratios_of_weights_matter(drawn, model, times):
    plain, scaled = (fit(drawn[1], weights, model, iterations=1) for weights in (None, np.full(68, times)))
    np.testing.assert_allclose(scaled.vertices, plain.vertices, atol=1e-3)
    np.testing.assert_array_equal(scaled.landmark_weights, times)


def test_a_fit_goes_on_from_another(fitted, drawn, model):
    """As while a landmark is dragged: the nose's tip goes down, and the nose grows."""
    dragged = drawn[1].copy()
    dragged[[30, 31, 32, 33, 34, 35]] += [0.0, 8.0]
    quick = fit(dragged, model=model, start=fitted[0], iterations=1)
    assert quick.rmse < 0.03 * eye_distance(drawn[1])

    def nose(found):
        root, tip = found.vertices[model.landmarks[[27, 30]]]
        return np.linalg.norm(tip - root)

    assert nose(quick) > nose(fitted[0]) + 2


def test_it_goes_on_only_from_a_fit_of_the_same_model(fitted, drawn):
    with pytest.raises(ValueError, match="same model"):
        fit(drawn[1], model=sw.FaceModel.load(), start=fitted[0])


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"iterations": 1.5}, "whole number of iterations, at least one; given 1.5"),
        ({"iterations": 0}, "given 0"),
        ({"iterations": True}, "given True"),
        ({"pull": -1}, "positive number; given -1"),
        ({"pull": "strong"}, "positive number; given 'strong'"),
        ({"start": "a face"}, "starts from a CaricatureFit; given str"),
    ],
)
def test_other_settings_are_refused(drawn, model, given, expected):
    with pytest.raises(ValueError, match=expected):
        fit(drawn[1], model=model, **given)


def test_extreme_landmarks_give_a_head(drawn, model):
    """A jaw three times as wide: whatever it looks like, it is finite and keeps to the landmarks."""
    wide = drawn[1].copy()
    middle = wide[:, 0].mean()
    wide[:17, 0] = middle + 3 * (wide[:17, 0] - middle)
    found = fit(wide, model=model)
    assert np.isfinite(found.vertices).all() and found.rmse < 0.25 * eye_distance(wide)


@pytest.mark.skipif(not PUBLISHED.is_dir(), reason="the published caricatures are not there")
def test_published_caricatures_are_met_better_than_by_the_papers_own_meshes(model):
    for name in ("1", "33", "44"):
        landmarks = np.loadtxt(PUBLISHED / f"{name}.txt")
        found = fit(landmarks, model=model)
        relative = found.errors / eye_distance(landmarks)
        assert np.sqrt((relative**2).mean()) < 0.0204
        assert np.sqrt((relative[17:] ** 2).mean()) < 0.0106
        assert np.sqrt((relative[:17] ** 2).mean()) < 0.0351
