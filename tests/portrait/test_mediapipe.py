"""The networks themselves: run where `sketchwidget models` has fetched them."""

import cv2
import numpy as np
import pytest
from skimage import data

from sketchwidget.portrait.mask import PersonMask, face_oval
from sketchwidget.portrait.mediapipe import MediaPipeDetector


@pytest.fixture(scope="module")
def portrait():
    return data.astronaut()


@pytest.fixture(scope="module")
def marks(portrait, portrait_models):
    detector = MediaPipeDetector()
    boxes = detector.faces(portrait)
    assert len(boxes) == 1
    return detector.landmarks(portrait, boxes[0])


def test_landmarks_lie_where_a_person_would_put_them(marks):
    by_eye = {8: (220, 177), 30: (223, 127), 36: (195, 101), 45: (256, 104), 48: (205, 140), 54: (244, 142)}
    for number, point in by_eye.items():
        assert np.linalg.norm(marks.points[number] - point) < 0.1 * marks.eye_distance
    assert marks.score > 0.9


def test_irises_lie_between_the_lids(marks):
    for side, (x, y, radius) in marks.irises.items():
        assert cv2.pointPolygonTest(marks.eyelids[side].astype(np.float32), (x, y), False) > 0
        assert 2 < radius < 6


def test_a_turned_and_scaled_picture_gives_turned_and_scaled_landmarks(portrait, marks):
    matrix = cv2.getRotationMatrix2D((225, 120), 25, 1.5)
    turned = cv2.warpAffine(portrait, matrix, (512, 512))
    detector = MediaPipeDetector()
    found = detector.landmarks(turned, detector.faces(turned)[0])
    expected = marks.points @ matrix[:, :2].T + matrix[:, 2]
    assert np.linalg.norm(found.points - expected, axis=1).mean() < 0.05 * found.eye_distance


def test_a_picture_without_a_face_has_none(portrait_models):
    assert MediaPipeDetector().faces(data.coffee()).shape == (0, 4)


def test_the_mask_takes_the_person_and_not_the_background(portrait, marks):
    mask = PersonMask()(portrait)
    assert mask.shape == portrait.shape[:2] and mask.dtype == np.float32
    assert mask[face_oval(marks.points, mask.shape)].mean() > 0.95
    assert mask[40:200, 20:90].mean() < 0.05
