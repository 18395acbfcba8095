import numpy as np
import pytest

import sketchwidget as sw
from sketchwidget.caricature import exaggerate


@pytest.fixture(scope="module")
def someone(model):
    return model.face(model.bilinear.identities[4 * 16], "laugh")


def test_one_is_the_head_itself_and_nothing_jumps_there(someone):
    assert exaggerate(someone, 1) is someone
    np.testing.assert_allclose(exaggerate(someone, 1 + 1e-6).vertices, someone.vertices, atol=2e-3)
    np.testing.assert_allclose(exaggerate(someone, 1 - 1e-6).vertices, someone.vertices, atol=2e-3)


def test_zero_is_the_mean_face(someone, model):
    np.testing.assert_allclose(exaggerate(someone, 0).vertices, model.mean, atol=1e-2)


def test_the_mean_face_has_nothing_to_exaggerate(model):
    np.testing.assert_allclose(exaggerate(model.face(), 3).vertices, model.mean, atol=0.1)


def test_what_stands_out_stands_out_more(someone, model):
    """Strictly, step by step, and a mouth that is open opens more."""
    heads = [exaggerate(someone, amount) for amount in (0, 0.5, 1, 1.5, 2, 3)]
    differences = [np.linalg.norm(head.vertices - model.mean, axis=1).mean() for head in heads]
    openings = [head.landmarks[62, 1] - head.landmarks[66, 1] for head in heads[:5]]
    assert (np.diff(differences) > 0).all() and (np.diff(openings) > 0).all()
    assert all(np.isfinite(head.vertices).all() for head in heads)


def test_a_caricature_can_be_softened(fitted, model):
    softer = exaggerate(fitted[0].face, 0.5)
    distance = [np.linalg.norm(mesh - model.mean, axis=1).mean() for mesh in (softer.vertices, fitted[0].vertices)]
    assert distance[0] < distance[1]


@pytest.mark.parametrize("amount", [-0.1, 3.01, np.nan, np.inf, "much", None])
def test_other_amounts_are_refused(someone, amount):
    with pytest.raises(ValueError, match="a number from 0 to 3"):
        exaggerate(someone, amount)


def test_the_room_is_public():
    assert sw.caricature.exaggerate is exaggerate
