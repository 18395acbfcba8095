import numpy as np
import pytest

from sketchwidget.caricature.exaggeration import exaggerate
from sketchwidget.face.handles import LINES
from sketchwidget.face.lining import Covered, Lining


@pytest.fixture(scope="module")
def lining(model):
    return Lining.of(model.template, model.mean)


def out(lining, head):
    """How many vertices of the inside of the mouth lie before all skin at their place."""
    room = lining.inside.room(head)
    return int((np.isfinite(room) & (room < -0.1)).sum())


def wider(model, head, by):
    lines = {name: head[model.curves[name], :2].astype(np.float64) for name in LINES}
    return model.handles(head, lines | {name: line * [by, 1] for name, line in lines.items() if "mouth" in name})


def test_room_by_hand():
    """A triangle of skin 3 mm above one of two points, and another as far below it."""
    head = np.array([[0.0, 0, 3], [2, 0, 3], [0, 2, 3], [0, 0, -3], [2, 0, -3], [0, 2, -3], [0.5, 0.5, 0], [3, 3, 0]])
    covered = Covered.by(np.array([[0, 1, 2], [3, 4, 5]]), np.array([6, 7]))
    np.testing.assert_allclose(covered.room(head), [3, -np.inf])
    lower = head - np.array([0, 0, 4]) * (np.arange(8) < 3)[:, None]
    np.testing.assert_allclose(covered.room(lower), [-1, -np.inf])
    np.testing.assert_allclose(covered.lacking(head, lower), [3, 0])  # 2 mm of room at most


def test_the_inside_of_a_wider_mouth_does_not_come_out_of_the_cheeks(model, lining, monkeypatch):
    head = exaggerate(model.face(model.bilinear.identities[0], "mouth_open"), 2.0).vertices
    assert out(lining, wider(model, head, 1.3)) == 0
    monkeypatch.setattr(Lining, "follow", lambda *heads: None)
    assert out(lining, wider(model, head, 1.3)) > 30


def test_what_is_behind_the_skin_stays(model, lining):
    moved = model.mean.copy()
    moved[:, 0] *= 1.1
    before = moved.copy()
    lining.follow(model.mean, moved)
    np.testing.assert_array_equal(moved, before)


def test_what_came_out_goes_back_to_its_room(model, lining):
    """A vertex behind the upper lip is pushed through it."""
    room = lining.scouts.room(model.mean)
    vertex = lining.scouts.vertices[np.argmax((room > 5) & (room < 15))]
    moved = model.mean.copy()
    moved[vertex, 2] += 20
    lining.follow(model.mean, moved)
    assert moved[vertex, 2] < model.mean[vertex, 2] + 13
    others = np.delete(np.arange(len(moved)), vertex)
    np.testing.assert_array_equal(moved[others], model.mean[others])
