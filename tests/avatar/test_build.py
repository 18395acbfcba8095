from dataclasses import replace

import numpy as np
import pytest

from sketchwidget.avatar import build
from sketchwidget.face import FaceModel
from sketchwidget.portrait import FaceLandmarks


class Detector:
    """Tells what it was told."""

    def __init__(self, boxes, points=None, score=1.0):
        self.boxes, self.points, self.score = np.array(boxes, dtype=float).reshape(-1, 4), points, score

    def faces(self, image):
        return self.boxes

    def landmarks(self, image, box):
        return FaceLandmarks(self.points, score=self.score)


def test_landmarks_of_the_head_lie_on_those_of_the_portrait(avatar, portrait):
    off = np.linalg.norm(avatar.project() - portrait[1], axis=1) / np.linalg.norm(portrait[1][36] - portrait[1][45])
    assert off[17:].mean() < 0.02 and off.mean() < 0.03


def test_the_head_is_near_the_one_in_the_picture(avatar, portrait):
    """Shape from one picture: the face within a few millimetres once both are aligned."""
    from sketchwidget.geometry.alignment import similarity

    found, true = avatar.portrait.vertices, portrait[2].vertices
    front = np.flatnonzero((true[:, 2] > 30) & (avatar.model.template.fine_parts == 0))
    scale, rotation, shift = similarity(found[front], true[front])
    off = np.linalg.norm(scale * found[front] @ rotation.T + shift - true[front], axis=1)
    assert off.mean() < 4.0


def test_two_people_give_two_heads(avatar, model):
    from sketchwidget.geometry.view import View

    head = model.face(identity=model.bilinear.identities[40])
    view = View(scale=1 / 300)
    other = build(head.picture(view, 640), view.project(head.landmarks) * 640, stylize=False)
    assert np.linalg.norm(other.face.vertices - avatar.face.vertices, axis=1).mean() > 2


def test_no_weights_is_the_face_and_eyes_turn_whole(avatar):
    assert np.allclose(avatar.pose({}), avatar.face.vertices, atol=1e-4)
    looking = avatar.pose({"eyeLookUpLeft": 1.0, "jawOpen": 0.5})
    eye = avatar.eyes[0]
    assert np.allclose(np.linalg.norm(looking[eye.vertices] - eye.centre, axis=1), eye.radius, atol=1e-3)
    assert np.abs(looking[eye.vertices] - avatar.face.vertices[eye.vertices]).max() > 2


def test_pixels_scale_with_the_picture(portrait):
    image, landmarks, _ = portrait
    large = build(np.repeat(np.repeat(image, 4, axis=0), 4, axis=1), landmarks * 4, stylize=False)
    assert np.linalg.norm(large.project() / 4 - landmarks, axis=1)[17:].mean() < 3
    assert np.allclose(large.camera.project(large.portrait.landmarks), large.project(), atol=0.5)


def test_without_models_landmarks_by_hand_are_enough(portrait):
    image, landmarks, _ = portrait
    assert build(image, landmarks, stylize=False).texture.dtype == np.uint8


def test_without_models_and_landmarks_it_says_what_to_run(portrait):
    with pytest.raises(ValueError, match="sketchwidget models"):
        build(portrait[0])


def test_another_detector_serves(portrait, avatar):
    image, landmarks, _ = portrait
    found = build(image, detector=Detector([[0, 0, 600, 600]], landmarks))
    assert np.array_equal(found.face.vertices, avatar.face.vertices)


@pytest.mark.parametrize(
    ("detector", "options", "told"),
    [
        (Detector([]), {}, "no face"),
        (Detector([[0, 0, 90, 90], [300, 0, 100, 100]]), {}, "2 faces"),
        (Detector([[0, 0, 90, 90], [300, 0, 100, 100]]), {"face": 2}, "face=2"),
        (Detector([[0, 0, 90, 90]], np.random.default_rng(0).uniform(0, 90, (68, 2)), 0.001), {}, "is none"),
    ],
)
def test_faces_that_are_none_or_many_are_told(portrait, detector, options, told):
    with pytest.raises(ValueError, match=told):
        build(portrait[0], detector=detector, **options)


def test_a_profile_a_small_face_and_wrong_landmarks_are_told(portrait):
    image, landmarks, _ = portrait
    aside = landmarks.copy()
    aside[:17, 0] += landmarks[37, 0] - landmarks[0, 0]
    with pytest.raises(ValueError, match="profile"):
        build(image, aside)
    with pytest.raises(ValueError, match="too small"):
        build(image, landmarks / 60)
    with pytest.raises(ValueError, match="68"):
        build(image, landmarks[:5])
    with pytest.raises(ValueError, match="20 x 20"):
        build(image[:20, :20], landmarks)


def test_the_shipped_network_begins_the_fit_and_can_be_left_out(portrait, avatar, model):
    """Its first guess is a head of the model, nearer to the one that is seen than the mean face is."""
    from sketchwidget.avatar.coarse import CoarseFitter
    from sketchwidget.avatar.network import PortraitNetwork
    from sketchwidget.avatar.template import AvatarTemplate
    from sketchwidget.geometry.alignment import similarity

    guess = PortraitNetwork.load(model).predict(avatar.stages["portrait"], CoarseFitter(model, AvatarTemplate.load()))
    true = portrait[2].vertices
    front = np.flatnonzero((true[:, 2] > 30) & (model.template.fine_parts == 0))

    def off(vertices):
        scale, rotation, shift = similarity(vertices[front], true[front])
        return np.linalg.norm(scale * vertices[front] @ rotation.T + shift - true[front], axis=1).mean()

    assert off(model.template.subdivision @ guess.vertices) < 0.8 * off(model.mean.astype(float))
    image, landmarks, _ = portrait
    without = build(image, landmarks, network=False)
    assert not np.array_equal(without.face.vertices, avatar.face.vertices)
    assert np.linalg.norm(without.face.vertices - avatar.face.vertices, axis=1).mean() < 3


def test_the_shipped_model_is_known_as_such_and_another_begins_at_the_mean_face(portrait, avatar, monkeypatch):
    from sketchwidget.avatar.network import PortraitNetwork

    image, landmarks, _ = portrait
    again = build(image, landmarks, model=FaceModel.load())
    np.testing.assert_array_equal(again.face.vertices, avatar.face.vertices)
    another = FaceModel.load()
    monkeypatch.setattr(another, "bilinear", replace(another.bilinear, core=1.01 * another.bilinear.core))
    asked = []
    monkeypatch.setattr(PortraitNetwork, "predict", lambda *given: asked.append(given))
    assert np.isfinite(build(image, landmarks, model=another).face.vertices).all() and not asked
