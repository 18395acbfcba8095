"""What a user may open by mistake: each is told with what to do, by `build` and in the Studio, with the real models."""

import io
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from PIL import Image
from skimage import data

import sketchwidget as sw
from sketchwidget.portrait.mediapipe import MediaPipeDetector
from sketchwidget.widgets import Studio


def behind_glasses():
    picture, detector = data.astronaut(), MediaPipeDetector()
    marks = detector.landmarks(picture, detector.faces(picture)[0])
    for eye in (slice(36, 42), slice(42, 48)):
        x, y = marks.points[eye].mean(axis=0).astype(int).tolist()
        breadth = np.ptp(marks.points[eye, 0])
        cv2.ellipse(picture, (x, y), (int(0.9 * breadth), int(0.75 * breadth)), 0, 0, 360, (10, 10, 12), -1)
    return picture


def file_of(picture):
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "PNG")
    return file.getvalue()


PICTURES = {
    "nobody": lambda: file_of(data.coffee()),
    "two": lambda: file_of(np.concatenate([data.astronaut()] * 2, axis=1)),
    "cat": lambda: file_of(data.chelsea()),
    "profile": lambda: file_of(data.camera()),
    "tiny": lambda: file_of(data.astronaut()[100:120, 200:220]),
    "corrupt": lambda: file_of(data.astronaut())[:3000],
    "pickle": lambda: b"\x80\x04\x95",
    "glasses": lambda: file_of(behind_glasses()),
}


@pytest.fixture
def studio(portrait_models, model):
    return Studio(sw.Session(SimpleNamespace(model=model), inference=False))


def named(content, name):
    return SimpleNamespace(content=content, name=name)


@pytest.mark.parametrize(
    ("name", "told", "said"),
    [
        ("nobody", "give a portrait, or the 68 landmarks", "No face was found in it. Click the outer corners"),
        ("two", "2 faces: choose one with face=0", "2 faces were found: W is for another one"),
        ("cat", "is none: give a portrait", "What looks like a face in it is none. Click the outer corners"),
        ("profile", "in which both eyes and both cheeks are seen", "A face was found"),
        ("tiny", "at least 64 a side", "20 x 20 pixels"),
        ("corrupt", "save it anew", "was not opened, all is as it was"),
        ("pickle", "give a JPEG, PNG", "was not opened, all is as it was"),
    ],
)
def test_it_is_told_what_to_do(studio, name, told, said):
    content = PICTURES[name]()
    with pytest.raises(ValueError, match=told):
        sw.avatar.build(content)
    studio.marking._on_file({"new": (named(content, name),), "owner": SimpleNamespace(value=())})
    assert said in studio._status.message


def test_sunglasses_are_told_and_do_not_stop_it(studio):
    content = PICTURES["glasses"]()
    with pytest.warns(UserWarning, match="sunglasses perhaps: give a picture without, or drag"):
        assert sw.avatar.build(content, stylize=False).texture.any()
    studio.marking._on_file({"new": (named(content, "glasses"),), "owner": SimpleNamespace(value=())})
    assert "sunglasses perhaps" in studio._status.message


@pytest.mark.parametrize("kind", ["grey", "16 bits"])
def test_grey_pictures_give_heads(portrait_models, kind):
    grey = cv2.cvtColor(data.astronaut(), cv2.COLOR_RGB2GRAY)
    picture = grey if kind == "grey" else grey.astype(np.uint16) * 257
    avatar = sw.avatar.build(picture, stylize=False)
    colour = avatar.texture[512, 512].astype(int)
    assert np.ptp(colour) < 40 and np.isfinite(avatar.face.vertices).all()
