import numpy as np
import pytest

from sketchwidget.face import PARTS
from sketchwidget.geometry import View
from sketchwidget.geometry.deformation_space import DeformationSpace
from sketchwidget.geometry.visibility import visible_vertices


def test_the_skin_at_rest_is_the_mean_face(head, model):
    np.testing.assert_allclose(head.vertices(head.rest[head.skin]), model.mean, atol=1e-3)


def testexamples_are_of_normal_faces_that_differ(head, model):
    expressions = [name for name in head.names if not name.startswith("identity")]
    assert len(expressions) + 20 == len(head.names) == head.space.size and "neutral" not in expressions
    assert "jaw_drop" in expressions and len(set(head.names)) == len(head.names)
    # No person is among them at a level of exaggeration: each is nearest to the first of the person's levels.
    for name in head.names[len(expressions) :][:3]:
        person = int(name.removeprefix("identity "))
        example = head.examples[head.names.index(name)]
        rest = [model.face(model.bilinear.identities[4 * person + level]).vertices for level in range(4)]
        distance = [np.abs(model.template.subdivision @ example - mesh).max() for mesh in rest]
        assert distance[0] < 1e-3 < min(distance[1:])


def test_unit_weights_give_each_example_within_half_a_millimetre(head):
    for number, example in enumerate(head.examples):
        weights = np.zeros((2, head.space.size))
        weights[:, number] = 1
        back = head.representation.aligned(head.space.vertices(weights))
        error = np.linalg.norm(back - head.representation.aligned(example[head.skin]), axis=1)
        assert np.sqrt((error**2).mean()) < 0.5, head.names[number]


def test_twoexamples_open_the_mouth_wider_than_either(head, model):
    """Figure 2: an open mouth and a person, at weights from -1 to 2.5."""
    open_mouth = head.coarse(model.face(expression="mouth_open").vertices)
    person = head.coarse(model.face(model.bilinear.identities[0]).vertices)
    space = DeformationSpace(head.representation, [mesh[head.skin] for mesh in (open_mouth, person)])
    upper, lower = model.landmarks[[62, 66]]

    def opening(by_expression, by_person):
        vertices = head.vertices(space.vertices(np.tile([by_expression, by_person], (2, 1))))
        return vertices[upper, 1] - vertices[lower, 1]

    openings = [opening(weight, 0) for weight in (-1, 0, 1, 1.75, 2.5)]
    assert (np.diff(openings) > 0).all()
    example = model.face(expression="mouth_open").vertices
    assert openings[2] == pytest.approx(example[upper, 1] - example[lower, 1], abs=1.0)
    assert opening(2.5, 0) > 1.8 * openings[2] and opening(1, 1) > opening(0, 1) + 5


def test_eyes_teeth_and_tongue_follow_a_turned_and_grown_head(head, model):
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    moved = head.vertices(1.3 * head.rest[head.skin] @ turn.T + [5, 6, 7])
    np.testing.assert_allclose(moved, 1.3 * model.mean @ turn.T + [5, 6, 7], atol=1e-3)


def test_eyes_teeth_and_tongue_come_with_a_laughing_person(head, model):
    """They are within a few millimetres of where the person's own are, farther from where the mean face has them."""
    face = model.face(model.bilinear.identities[4 * 7], "laugh")
    followed = head.vertices(head.coarse(face.vertices)[head.skin])
    for part, most in (("eyes", 3), ("teeth", 7), ("tongue", 8)):
        vertices = model.template.fine_parts == PARTS.index(part)
        error = np.linalg.norm(followed - face.vertices, axis=1)[vertices].mean()
        assert error < most, part


def test_teeth_stay_behind_cheeks_that_get_narrower(head, model):
    """A head narrowed below the eyes, as gaunt caricatures are: no tooth is seen from the side."""
    skin = head.rest[head.skin].copy()
    skin[:, 0] *= np.interp(skin[:, 1], [-60, 10], [0.6, 1.0])
    gaunt = head.vertices(skin)
    teeth = np.flatnonzero(model.template.fine_parts == PARTS.index("teeth"))
    for side in ("left", "right", "three-quarter"):
        rotation = View.preset(side).rotation
        assert not visible_vertices(gaunt, model.faces, rotation, teeth).any(), side
