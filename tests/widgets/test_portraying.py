"""The Portrait tab without a page: heads are built at once, by a builder that answers at once."""

import re
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

import sketchwidget as sw
from sketchwidget.face.texture import Texture
from sketchwidget.portrait import FaceLandmarks
from sketchwidget.widgets import Studio, marking

PICTURE = np.full((400, 400, 3), 128, dtype=np.uint8)
JPEG = cv2.imencode(".jpg", PICTURE)[1].tobytes()


@pytest.fixture(scope="module")
def someone(model):
    return model.face(model.bilinear.identities[4 * 33])


@pytest.fixture
def built(someone, models, monkeypatch):
    """Tells what `build` was given; the landmarks of its heads are the face's."""
    given = []

    def build(picture, marks, model=None, report=None):
        given.append(marks)
        models.append(model)
        if picture.max() == 0:
            raise ValueError("the face is seen in profile")
        report("landmarks", 1.0, marks.points)
        report("coarse", 20.0, someone.vertices)
        report("texture", 5.0, np.zeros((64, 64, 3), dtype=np.uint8))
        return SimpleNamespace(
            face=someone,
            rig={},
            eyes=(),
            skin=Texture(JPEG, np.zeros((len(someone.vertices), 2))),
            timings={"coarse": 20.0},
        )

    monkeypatch.setattr("sketchwidget.avatar.build", build)
    return given


@pytest.fixture
def models():
    """The face models that `build` was given."""
    return []


@pytest.fixture
def studio(model, monkeypatch):
    monkeypatch.setattr(marking, "missing", lambda: ["face_detection"])
    return Studio(sw.Session(SimpleNamespace(model=model), inference=False))


@pytest.fixture
def tab(studio, built):
    studio._mode.value = "portrait"
    studio.marking.open(PICTURE, "someone.png")
    studio.marking.place(np.random.default_rng(0).uniform(100, 300, (68, 2)))
    return studio


def test_landmarks_give_a_textured_head_stage_by_stage(tab, someone):
    portraying = tab._tabs["portrait"]
    assert tab._head._face is someone and tab._head._skin is portraying.skin
    captions = [re.search(r"<figcaption>(.*)</figcaption>", figure)[1] for figure in portraying._figures]
    assert captions == ["landmarks<br>1 ms", "coarse<br>20 ms", "texture<br>5 ms"]
    assert tab._status.message.startswith("The head is built in 0.0 s")


def test_another_drag_builds_anew_and_coming_back_does_not(tab, built):
    points = tab.marking.present.points.copy()
    points[3] += 5
    tab.marking.place(points)
    assert len(built) == 2
    tab._mode.value = "initial"
    tab._mode.value = "portrait"
    assert len(built) == 2 and tab._head._skin is not None


def test_the_texture_stays_on_the_head_taken_over_until_that_is_undone(tab, someone):
    portraying = tab._tabs["portrait"]
    portraying._on_take()
    assert tab.session.mode == "followup" and tab._head._skin is portraying.skin
    np.testing.assert_allclose(tab.session.face.vertices, someone.vertices, atol=0.01)
    tab._on_undo()
    assert tab._head._skin is None
    tab._on_redo()
    assert tab._head._skin is portraying.skin
    tab._on_exaggerate(1.5)
    assert tab.session.exaggeration == 1.5 and tab._head._skin is portraying.skin


def test_a_session_that_is_loaded_shows_the_texture_and_exports_it(tab):
    tab._tabs["portrait"]._on_take()
    saved, skin = tab.session.dumps(), tab.session.texture
    tab._on_clear()
    tab._on_undo()
    tab._on_undo()
    assert tab._head._skin is None
    tab._files.load("someone.jsonl", saved.encode())
    assert tab._head._skin.picture == skin.picture and np.array_equal(tab._head._skin.uv, skin.uv)
    assert tab._exported.to_bytes("glb").startswith(b"glTF")


def test_other_tabs_show_their_heads_of_clay(tab):
    tab._mode.value = "initial"
    assert tab._head._skin is None


def test_what_is_exported_is_the_avatar(tab):
    assert tab._exported is tab._tabs["portrait"].avatar
    tab._mode.value = "initial"
    assert tab._exported is tab._face


def test_heads_are_built_with_the_session_s_model(tab, models, model):
    assert models and all(given is model for given in models)


def test_a_picture_that_gives_no_head_is_a_sentence(studio, built):
    studio._mode.value = "portrait"
    studio.marking.open(np.zeros_like(PICTURE), "aside.png")
    studio.marking.place(np.random.default_rng(0).uniform(100, 300, (68, 2)))
    assert studio._status.message == "There is no head of this picture: The face is seen in profile."
    studio._tabs["portrait"]._on_take()
    assert studio.session.mode != "refine" and "no head to take over" in studio._status.message


@pytest.mark.parametrize("name", ["caricature", "portrait"])
def test_what_fails_for_a_tab_that_was_left_is_not_told_in_another(studio, name):
    studio._mode.value = name
    studio._mode.value = "followup"
    before = studio._status.message
    studio._tabs[name]._on_failure(ValueError("the face is seen in profile"))
    assert studio._status.message == before


def test_eyelids_that_were_found_count_until_the_eye_is_corrected():
    points = np.random.default_rng(1).uniform(0, 300, (68, 2))
    found = FaceLandmarks(points, {"left": np.zeros((16, 2)), "right": np.ones((16, 2))})
    moved = points.copy()
    moved[36] += 1  # the subject's right eye
    assert set(marking.Marked(PICTURE, points, found=found).marks.eyelids) == {"left", "right"}
    assert set(marking.Marked(PICTURE, moved, found=found).marks.eyelids) == {"left"}
