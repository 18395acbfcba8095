"""Fits to portraits whose head, pose and light are known."""

import numpy as np
import pytest
import torch

from sketchwidget.avatar.coarse import CoarseFitter
from sketchwidget.avatar.fine import FineFitter, along_lids
from sketchwidget.portrait import FaceLandmarks
from sketchwidget.training.portraits import render_portrait


@pytest.fixture(scope="module")
def known(model, template):
    return render_portrait(model, template, 7, side=256)


@pytest.fixture(scope="module")
def fitter(model, template):
    return CoarseFitter(model, template)


@pytest.fixture(scope="module")
def fit(fitter, known):
    return fitter.fit(known.image, known.landmarks, known.mask.astype(float))


def test_pose_is_found(fit, known):
    between = fit.camera.rotation @ known.camera.rotation.T
    degrees = np.degrees(np.arccos(np.clip((np.trace(between) - 1) / 2, -1, 1)))
    assert degrees < 5 and abs(fit.camera.scale / known.camera.scale - 1) < 0.05


def test_landmarks_lie_on_their_lines(model, fit, known):
    points = fit.camera.project((model.template.subdivision @ fit.vertices)[model.landmarks])
    off = np.linalg.norm(points - known.landmarks, axis=1) / fit.camera.scale
    assert off[27:].mean() < 1.5  # millimetres


def test_colours_come_nearer_than_the_mean_albedos(model, template, fit, known):
    true, found = (
        template.albedo + np.tensordot(texture, template.albedo_basis, axes=1)
        for texture in (known.texture, fit.texture)
    )
    cheek = np.abs(template.neutral[:, 0]) < 45
    cheek &= (template.neutral[:, 1] < -10) & (template.neutral[:, 1] > -50) & (template.neutral[:, 2] > 50)
    # Skin that is darker under more light looks the same: hue is what a picture shows.
    hue = [colours[cheek] / colours[cheek].sum(axis=1, keepdims=True) for colours in (true, found, template.albedo)]
    assert np.abs(hue[1] - hue[0]).mean() < np.abs(hue[2] - hue[0]).mean()


def test_the_loss_of_the_truth_is_less_than_that_of_the_mean_face(fitter, known):
    from sketchwidget.avatar.coarse import as_tensors, landmark_weights

    picture, sure = as_tensors(known.image, known.mask.astype(float))
    weights, wanted = (torch.from_numpy(a.astype(np.float32)) for a in (landmark_weights(), known.landmarks))
    mean = fitter.unknowns(fitter.mean_face(known.landmarks))
    found = fitter.unknowns(fitter.fit(known.image, known.landmarks, known.mask.astype(float)))
    with torch.no_grad():
        losses = [fitter.loss(u, wanted, weights, picture, sure, fitter.visible(u)) for u in (mean, found)]
    assert losses[1] < 0.5 * losses[0]


def test_fine_anchors_are_met_and_the_back_of_the_head_stays(model, fit, known):
    """Equation 10, with an eye that no head of the model has."""
    wanted = known.landmarks.copy()
    eye = slice(42, 48)
    wanted[eye] = wanted[eye].mean(axis=0) + 1.4 * (wanted[eye] - wanted[eye].mean(axis=0))
    posed = FineFitter(model).fit(fit, FaceLandmarks(wanted))
    refine = model.template.subdivision
    before, after = (fit.camera.project((refine @ v)[model.landmarks])[eye] for v in (fit.vertices, posed))
    assert (
        np.linalg.norm(after - wanted[eye], axis=1).mean() < 0.15 * np.linalg.norm(before - wanted[eye], axis=1).mean()
    )
    back = (model.template.parts == 0) & (fit.vertices[:, 2] < -30)
    assert np.linalg.norm(posed - fit.vertices, axis=1)[back].max() < 1.0


def test_at_rest_the_corners_of_a_smile_hang_no_lower_than_the_models(model, fitter, known):
    """Between the lips runs the line of the same person's mouth at rest."""
    posed, rest = (fitter.coarse(known.identity, model.expression_weights(name)) for name in ("smile", "neutral"))
    stretched = posed * (1.1, 1.0, 1.0)
    found = FineFitter(model).neutral(stretched, posed, rest)
    upper, lower = model.curves["mouth_upper"], model.curves["mouth_lower"]
    refine = model.template.subdivision
    drop = []
    for head in (refine @ found, refine @ rest, refine @ stretched):
        line = np.interp(np.linspace(0, 1, 9), np.linspace(0, 1, len(upper)), head[upper, 1])
        line = (line + np.interp(np.linspace(0, 1, 9), np.linspace(0, 1, len(lower)), head[lower, 1])) / 2
        drop.append(line[[0, -1]].mean() - line[4])
    assert drop[2] > drop[1] + 2  # it does smile
    assert abs(drop[0] - drop[1]) < 0.4


def test_what_is_aligned_already_does_not_move(model, fit):
    points = fit.camera.project((model.template.subdivision @ fit.vertices)[model.landmarks])
    posed = FineFitter(model).fit(fit, FaceLandmarks(points))
    skin = model.template.parts == 0
    assert np.abs(posed - fit.vertices)[skin].max() < 1e-6


def test_places_along_the_lids_by_hand():
    """A square whose outer corner is at the left: lower lid below, upper lid above, y down."""
    contour = np.array([[0.0, 0], [1, 1], [2, 0], [1, -1]])
    points = along_lids(contour, np.array([0.0, 0.5, 1.0, 1.5, 2.0]))
    assert np.allclose(points, [[0, 0], [1, 1], [0, 0], [1, -1], [2, 0]], atol=0.05)
