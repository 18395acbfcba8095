"""The picture and its landmarks, without a page."""

import io
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from sketchwidget.portrait import FaceLandmarks
from sketchwidget.widgets import marking as room
from sketchwidget.widgets.marking import LINES, Marking
from sketchwidget.widgets.status import Status

PICTURE = np.full((300, 400, 3), 200, dtype=np.uint8)
CLICKS = [[150.0, 120.0], [250.0, 118.0], [200.0, 230.0]]
POINTS = np.random.default_rng(0).uniform(50, 250, (68, 2))


class Detector:
    def __init__(self, count):
        self.count = count

    def faces(self, image):
        return np.tile([0.0, 0, 300, 300], (self.count, 1))

    def landmarks(self, image, box):
        return FaceLandmarks(POINTS)


def marking(count):
    made = Marking(Status(), Detector(count))
    made.told = []
    made.on_change(lambda marked, done: made.told.append((marked, done)))
    return made


def upload(made, data, name="face.png"):
    owner = SimpleNamespace(value=None)
    made._on_file({"new": [SimpleNamespace(name=name, content=data)], "owner": owner})
    assert owner.value == ()


def png(picture=PICTURE):
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "PNG")
    return file.getvalue()


def test_a_found_face_is_marked():
    made = marking(1)
    upload(made, png())
    assert made._status.message == "face.png is open. A face was found. Drag any landmark to where it belongs."
    np.testing.assert_array_equal(made.present.landmarks, POINTS)
    assert len(made.pad.lines) == len(LINES) and not made.pad.clickable
    ((marked, done),) = made.told
    assert done and marked.picture.shape == PICTURE.shape


def test_without_a_face_three_clicks_begin_one():
    made = marking(0)
    upload(made, png())
    assert made.pad.clickable and made.present.landmarks is None
    for click, expected in zip(CLICKS, ("corner of the other eye", "the chin", "Drag"), strict=True):
        made._on_click(np.array(click))
        assert expected in made._status.message
    np.testing.assert_allclose(made.present.landmarks[[36, 45, 8]], CLICKS, atol=1e-6)
    assert not made.pad.clickable
    made._on_click(np.array(CLICKS[0]))
    assert len(made.present.points) == 68


def test_clicks_that_span_no_face_are_told_and_the_two_before_stay():
    made = marking(0)
    made.open(PICTURE)
    for click in (*CLICKS[:2], [200.0, 119.0]):
        made._on_click(np.array(click))
    assert made._status.message.startswith("No face can be there: The chin lies below the eyes")
    assert len(made.present.points) == 2


def test_without_models_the_status_says_how_to_get_them(monkeypatch):
    monkeypatch.setattr(room, "missing", lambda: ["face_detection"])
    made = Marking(Status())
    made.open(PICTURE)
    assert "`sketchwidget models`). Click the outer corners of both eyes" in made._status.message


def test_a_detector_that_fails_leaves_the_picture_and_the_clicks():
    class Damaged(Detector):
        def faces(self, image):
            raise ValueError("the model is damaged")

    made = Marking(Status(), Damaged(1))
    made.open(PICTURE)
    assert "The model is damaged. Click the outer corners" in made._status.message and made.pad.clickable


def test_a_dragged_landmark_is_told_and_counts_when_it_is_let_go():
    made = marking(1)
    made.open(PICTURE)
    made._on_move(30, np.array([10.0, 20.0]), False)
    marked, done = made.told[-1]
    assert not done and marked.landmarks[30].tolist() == [10, 20]
    np.testing.assert_array_equal(made.present.landmarks, POINTS)
    made._on_move(30, np.array([11.0, 21.0]), True)
    assert made.told[-1][1] and made.present.landmarks[30].tolist() == [11, 21] and made.pad.points[30] == [11, 21]
    made._on_move(68, np.array([0.0, 0.0]), True)
    assert len(made.told) == 3


def test_everything_can_be_undone():
    made = marking(1)
    assert not made.undo() and not made.redo() and not made.clear()
    made.open(PICTURE)
    made._on_move(30, np.array([11.0, 21.0]), True)
    assert made.clear() and len(made.present.points) == 0 and made.present.picture is not None
    assert made.clear() and made.present.picture is None and made.pad.size == [0, 0]
    assert made.undo() and made.undo() and made.present.landmarks[30].tolist() == [11, 21] and made.pad.size[0] == 400
    assert made.undo() and made.undo() and not made.undo() and made.present.picture is None
    assert made.redo() and made.present.landmarks is not None


def test_of_many_pictures_undo_brings_back_the_last_few():
    made = marking(0)
    for number in range(9):
        made.open(PICTURE + np.uint8(number))
        made._on_click(np.array(CLICKS[0]))
    for number in range(8, 9 - room.PICTURES, -1):
        assert made.undo() and made.undo() and made.present.picture[0, 0, 0] == 199 + number
    assert made.undo() and not made.undo()  # the click on the oldest
    assert made.present.picture[0, 0, 0] == 200 + 9 - room.PICTURES


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"no picture", "no picture that can be read"),
        (b"", "no picture"),
        (png()[:200], "damaged"),
        (png(np.zeros((10, 10, 3), dtype=np.uint8)), "10 x 10 pixels"),
    ],
)
def test_a_bad_file_changes_nothing(data, reason):
    made = marking(1)
    made.open(PICTURE)
    before = made.present
    upload(made, data, "bad.png")
    assert made._status.message.startswith("bad.png was not opened") and reason in made._status.message
    assert made.present is before


class Two(Detector):
    """Two faces, the larger one on the right."""

    def __init__(self):
        super().__init__(2)

    def faces(self, image):
        return np.array([[200.0, 0, 120, 120], [0, 0, 100, 100]])

    def landmarks(self, image, box):
        return FaceLandmarks(box[:2] + POINTS / 3)


def test_of_several_faces_the_largest_is_marked_and_the_next_on_demand():
    made = Marking(Status(), Two())
    made.open(PICTURE, "two.png")
    assert "2 faces were found" in made._status.message and made._another.layout.display is None
    np.testing.assert_allclose(made.present.points, [200, 0] + POINTS / 3)
    made._on_another()
    np.testing.assert_allclose(made.present.points, POINTS / 3)
    assert made._status.message.startswith("This is face 1 of 2.")
    made.undo()
    np.testing.assert_allclose(made.present.points, [200, 0] + POINTS / 3)


def test_models_that_are_missing_are_fetched_and_the_face_is_looked_for(monkeypatch):
    here = []
    monkeypatch.setattr(room, "missing", lambda: [] if here else ["face_detection"])
    monkeypatch.setattr(room, "fetch", lambda: here.append(True))
    monkeypatch.setattr(room, "MediaPipeDetector", lambda: Detector(1))
    made = Marking(Status())
    made.open(PICTURE, "face.png")
    assert made.pad.clickable and made._models.layout.display is None
    made._on_models()
    assert made._models.layout.display == "none" and made.present.landmarks is not None
    assert made._status.message.startswith("The models that find faces are here. A face was found.")


def test_models_that_cannot_be_fetched_leave_the_clicks(monkeypatch):
    monkeypatch.setattr(room, "missing", lambda: ["face_detection"])
    monkeypatch.setattr(room, "fetch", lambda: (_ for _ in ()).throw(OSError("there is no network")))
    made = Marking(Status())
    made.open(PICTURE, "face.png")
    made._on_models()
    assert "click three points instead: There is no network." in made._status.message and made.pad.clickable
