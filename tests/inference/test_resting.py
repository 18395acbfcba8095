"""A mouth that nobody has drawn."""

import numpy as np
import pytest

import sketchwidget as sw
from sketchwidget.face.drawing import outline
from sketchwidget.geometry.view import View
from sketchwidget.inference.resting import MouthAtRest, mouth_may_be_drawn
from sketchwidget.inference.shape_code import LINES, sample
from sketchwidget.sketch import SILHOUETTE, UNNAMED, WRINKLE

MOUTH, OTHERS = slice(48, 68), slice(17, 48)
turn = np.linspace(0, 2 * np.pi, 60)
OVAL = np.stack([0.5 + 0.27 * np.sin(turn), 0.5 - 0.39 * np.cos(turn)], axis=1)


@pytest.fixture(scope="module")
def model():
    return sw.FaceModel.load()


@pytest.fixture(scope="module")
def at_rest(model):
    basis = model.bilinear.basis.reshape(-1, 3, model.bilinear.basis.shape[1])
    pick = model.template.subdivision[model.landmarks]
    landmarks = np.stack([pick @ basis[:, axis] for axis in range(3)], axis=1).reshape(3 * len(model.landmarks), -1)
    return MouthAtRest(model, landmarks, model.bilinear.expressions.std(axis=0))


@pytest.fixture(scope="module")
def points(model):
    """The lines of the mean face."""
    lines = {name: View().project(model.face().curve(name)) for name in LINES}
    return sample(lines | {SILHOUETTE: outline(lines[SILHOUETTE])})


@pytest.mark.parametrize("name", ["smile", "laugh", "jaw_drop", "anger"])
@pytest.mark.parametrize("person", [0, 41, 203])
def test_the_mouth_rests_and_the_rest_of_the_face_stays(model, at_rest, name, person):
    identity = model.bilinear.identities[person]
    before, rest = model.face(identity, name), model.face(identity)
    after = model.face(identity, at_rest(identity, model.expression_weights(name))).landmarks

    def apart(one, two, of):
        return np.linalg.norm(one[of] - two[of], axis=1).mean()

    moved = apart(before.landmarks, rest.landmarks, MOUTH)
    assert apart(after, rest.landmarks, MOUTH) < max(0.3 * moved, 0.5)
    assert apart(after, before.landmarks, OTHERS) < max(0.4 * apart(before.landmarks, rest.landmarks, OTHERS), 0.5)


def test_a_face_at_rest_stays_as_it_is(model, at_rest):
    identity, rest = model.bilinear.identities[7], model.expression_weights("neutral")
    np.testing.assert_allclose(at_rest(identity, rest), rest, atol=1e-6)


def test_an_oval_and_two_eyes_give_a_person_at_rest(model):
    eye = np.stack([0.05 * np.sin(turn), 0.02 * np.cos(turn)], axis=1)
    for strokes in ([OVAL], [OVAL, eye + np.array([0.4, 0.47]), eye + np.array([0.6, 0.47])]):
        face = sw.FaceRegressor.load().predict(sw.Sketch.from_strokes(strokes))
        off = np.linalg.norm(face.landmarks[MOUTH] - model.face(face.identity).landmarks[MOUTH], axis=1)
        assert off.mean() < 0.5


def test_hair_and_a_neck_leave_a_mouth_at_rest_that_is_not_drawn(model):
    eye = np.stack([0.05 * np.sin(turn), 0.02 * np.cos(turn)], axis=1)
    hair = np.stack([0.5 + 0.33 * np.sin(turn[15:46] + np.pi), 0.45 - 0.45 * np.cos(turn[15:46] + np.pi)], axis=1)
    neck = np.array([[0.42, 0.9], [0.42, 0.99]])
    strokes = [OVAL, eye + np.array([0.4, 0.47]), eye + np.array([0.6, 0.47]), hair, neck]
    face = sw.FaceRegressor.load().predict(sw.Sketch.from_strokes(strokes))
    off = np.linalg.norm(face.landmarks[MOUTH] - model.face(face.identity).landmarks[MOUTH], axis=1)
    assert off.mean() < 0.5


def test_a_drawn_mouth_counts_and_so_does_what_may_be_one(points):
    def may_be_drawn(*named):
        strokes, names, places = zip(*[(OVAL, SILHOUETTE, "inside"), *named], strict=True)
        return mouth_may_be_drawn(strokes, names, places, points)

    mouth = np.array([[0.4, 0.68], [0.5, 0.71], [0.6, 0.68]])
    forehead, nose = mouth - (0.0, 0.45), np.array([[0.47, 0.62], [0.5, 0.64], [0.53, 0.62]])
    for name in ("mouth_upper", "nose", WRINKLE):
        assert may_be_drawn((mouth, name, "inside"))
    for name in (WRINKLE, "left_brow"):
        assert not may_be_drawn((forehead, name, "inside"))
    for name in ("nose", "left_eye_lower"):  # a low eye is no mouth
        assert not may_be_drawn((nose, name, "inside"))
    broad = nose * (4, 1) - (1.5, 0.0)
    assert may_be_drawn((broad, "nose", "inside")) and may_be_drawn((nose, WRINKLE, "inside"))
    assert not may_be_drawn((mouth, "left_ear", "ear")) and not may_be_drawn()
    # Beside what is inside, what is outside is hair; if all is outside, the outline may be a mouth.
    assert not may_be_drawn((forehead, "left_brow", "inside"), (mouth, UNNAMED, "outside"))
    assert may_be_drawn((forehead, UNNAMED, "outside"))
