"""The Caricature tab without a page: fits are done at once."""

from types import SimpleNamespace

import numpy as np
import pytest

import sketchwidget as sw
from sketchwidget.caricature import Camera
from sketchwidget.geometry import rotation_about_y
from sketchwidget.session.take_over import standing
from sketchwidget.widgets import Studio, caricaturing

PICTURE = np.full((400, 400, 3), 128, dtype=np.uint8)
UNDER = 33  # the nose


@pytest.fixture(scope="module")
def someone(model):
    return model.face(model.bilinear.identities[4 * 33])


@pytest.fixture(scope="module")
def landmarks(someone):
    return Camera(1.3, rotation_about_y(12), np.array([200.0, 200.0])).project(someone.landmarks.astype(float))


@pytest.fixture(autouse=True)
def few_iterations(monkeypatch):
    monkeypatch.setattr(caricaturing, "ITERATIONS", 2)


@pytest.fixture
def session(model):
    """A session of the one model, whose heads are prepared once for all tests."""
    return sw.Session(SimpleNamespace(model=model), inference=False)


@pytest.fixture
def studio(session):
    return Studio(session)


@pytest.fixture
def tab(studio, landmarks):
    studio._mode.value = "caricature"
    studio.marking.open(PICTURE, "someone.png")
    studio.marking.place(landmarks)
    return studio


def shown(studio):
    return studio._head._face


def test_whoever_comes_to_the_tab_is_told_that_the_head_is_being_fitted(studio, landmarks, monkeypatch):
    studio._mode.value = "portrait"
    studio.marking.open(PICTURE, "someone.png")
    studio.marking.place(landmarks)
    worker, jobs = studio._tabs["caricature"]._worker, []
    monkeypatch.setattr(worker, "do", jobs.append)
    studio._mode.value = "caricature"
    assert studio._status.message.endswith(caricaturing.FITTING)
    worker._answer(jobs[-1])
    assert studio._status.message.startswith("The head fits the landmarks")


def test_the_tab_shows_the_session_s_head_until_there_are_landmarks(studio):
    drawn = shown(studio)
    studio._mode.value = "caricature"
    assert shown(studio) is drawn and "sketchwidget-at-caricature" in studio._dom_classes
    assert studio._status.message.startswith("Open a picture of a face")
    studio._tabs["caricature"]._on_take()
    assert studio._status.message.startswith("There is no head to take over yet.")
    studio._mode.value = "followup"
    assert "sketchwidget-at-drawing" in studio._dom_classes and studio.session.mode == "followup"


def test_the_head_follows_a_dragged_landmark_and_is_fitted_once_it_is_let_go(tab, landmarks, model, sent):
    assert tab._status.message.startswith("The head fits the landmarks")
    before, messages = shown(tab), sent(tab._head.widget)
    tab.marking._on_move(UNDER, landmarks[UNDER] + [0, 12], False)
    quick = shown(tab)
    assert messages[-1][0]["passing"] is True
    assert quick.landmarks[UNDER, 1] < before.landmarks[UNDER, 1] - 4
    tab.marking._on_move(UNDER, landmarks[UNDER] + [0, 12], True)
    assert messages[-1][0]["passing"] is False and shown(tab) is not quick
    assert shown(tab).landmarks[UNDER, 1] < before.landmarks[UNDER, 1] - 4
    tab._undo.click()
    np.testing.assert_allclose(shown(tab).vertices, before.vertices, atol=1e-3)


def test_bad_landmarks_are_told_and_the_head_stays(tab, landmarks):
    before = shown(tab)
    tab.marking.place(landmarks * [-1, 1] + [400, 0])
    assert "the one before is kept: The landmarks are a mirror image" in tab._status.message
    assert shown(tab) is before
    tab._undo.click()
    assert tab._status.message.startswith("Undone") and np.array_equal(tab.marking.present.landmarks, landmarks)


def test_the_slider_goes_beyond_the_picture(tab):
    fitted = shown(tab)
    tab._exaggerating._slider.value = 1.5
    expected = sw.caricature.exaggerate(fitted, 1.5)
    np.testing.assert_allclose(shown(tab).vertices, expected.vertices, atol=1e-3)
    assert not tab.session.events[1:], "the session is not touched"
    tab._mode.value = "followup"
    assert tab._exaggerating._slider.value == 1.0
    tab._mode.value = "caricature"
    assert tab._exaggerating._slider.value == 1.5


def test_a_head_is_taken_over_and_the_tab_keeps_its_own(tab):
    fitted = shown(tab)
    tab._tabs["caricature"]._take.click()
    assert tab.session.mode == tab._mode.value == "followup"
    assert tab._status.message.startswith("The head is taken over; undo brings the drawing back.")
    np.testing.assert_allclose(shown(tab).vertices, fitted.vertices, atol=0.01)
    assert tab._head._frame.scale == standing(fitted).scale
    tab._undo.click()
    assert np.abs(shown(tab).vertices - fitted.vertices).max() > 1
    tab._mode.value = "caricature"
    np.testing.assert_array_equal(shown(tab).vertices, fitted.vertices)


def test_clearing_takes_the_landmarks_then_the_picture(tab):
    drawn = tab.session.face
    tab._clear.click()
    assert shown(tab) is drawn and tab.marking.present.picture is not None
    tab._clear.click()
    assert tab.marking.present.picture is None
    tab._undo.click()
    tab._undo.click()
    assert tab.marking.present.landmarks is not None and shown(tab) is not drawn


def test_a_new_session_shows_the_tab_of_its_mode(tab):
    tab.session = sw.Session(tab.session.regressor, inference=False)
    assert tab._mode.value == "followup" and shown(tab) is tab.session.face


def test_the_template_is_drawn_from_any_tab(tab):
    tab._on_template()
    assert tab._mode.value == "followup" and "sketchwidget-at-drawing" in tab._dom_classes


def test_the_slider_exaggerates_the_session_s_head_in_one_step(studio, someone):
    studio.session.take_over(someone)
    taken = shown(studio)
    for amount in (1.2, 1.4, 2.0):
        studio._exaggerating._slider.value = amount
    assert studio.session.exaggeration == 2.0 and studio._status.message.startswith("Exaggerated by a factor of 2.00")
    assert np.abs(shown(studio).vertices - taken.vertices).max() > 3
    studio._exaggerating._slider.value = 1.0
    assert shown(studio) is taken and studio._status.message.startswith("The head is as it was.")
    studio._exaggerating._slider.value = 2.0
    studio._undo.click()
    assert studio._exaggerating._slider.value == 1.0
    np.testing.assert_allclose(shown(studio).vertices, taken.vertices, atol=0.01)


def test_an_empty_pad_has_nothing_to_exaggerate():
    studio = Studio()
    studio._exaggerating._slider.value = 2.0
    assert "nothing to exaggerate" in studio._status.message and studio._exaggerating._slider.value == 1.0
    assert not studio.session.events
