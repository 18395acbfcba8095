import cv2
import numpy as np
import pytest

from sketchwidget.portrait import FaceLandmarks
from sketchwidget.portrait.doubts import eyes_hidden, is_face

ANGLES = np.linspace(0, 2 * np.pi, 16, endpoint=False)
EYES = {"right": (75.0, 90.0), "left": (125.0, 90.0)}


def marks():
    lids = {
        side: np.array(at) + np.column_stack([14 * np.cos(ANGLES), 5 * np.sin(ANGLES)]) for side, at in EYES.items()
    }
    points = np.random.default_rng(0).uniform(50, 150, (68, 2))
    points[27], points[33] = (100, 90), (100, 115)
    return FaceLandmarks(points, lids)


def face(skin, white, pupil, lens=None):
    image = np.full((200, 200, 3), skin, dtype=np.uint8)
    for at in EYES.values():
        middle = tuple(map(int, at))
        cv2.ellipse(image, middle, (14, 5), 0, 0, 360, (white,) * 3, -1)
        cv2.circle(image, middle, 5, (pupil,) * 3, -1)
        if lens is not None:
            cv2.ellipse(image, middle, (24, 18), 0, 0, 360, (lens,) * 3, -1)
    return image


@pytest.mark.parametrize("skin", [220, 110, 60])
def test_bare_eyes_are_seen_and_dark_lenses_hide_them_on_any_skin(skin):
    assert not eyes_hidden(face(skin, 200, 20), marks())
    assert not eyes_hidden(face(skin, skin, 20), marks())  # closed, or narrow
    assert eyes_hidden(face(skin, 200, 20, lens=12), marks())


def test_one_eye_behind_hair_is_no_reason_and_neither_are_lids_unknown():
    image = face(220, 200, 20)
    image[60:120, :100] = 10
    assert not eyes_hidden(image, marks())
    assert not eyes_hidden(face(220, 200, 20, lens=12), FaceLandmarks(marks().points))


def test_a_score_of_next_to_nothing_is_no_face():
    points = marks().points
    assert is_face(FaceLandmarks(points, score=0.03)) and not is_face(FaceLandmarks(points, score=0.009))
