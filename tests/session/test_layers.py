"""Layers on a real face model."""

import numpy as np
import pytest
from folds import turned_over

from sketchwidget.caricature import exaggerate
from sketchwidget.face import Face
from sketchwidget.session import Displacement, Layers


class Moved:
    def __init__(self, by):
        self.by = np.asarray(by, dtype=np.float32)

    def on(self, head):
        return Face(head.model, head.vertices + self.by)


def test_a_head_without_layers_is_the_parameters_own(model):
    face = model.face()
    assert Layers(face).head is face


def test_layers_are_applied_in_their_order(model):
    class Doubled:
        def on(self, head):
            return Face(head.model, 2 * head.vertices)

    head = Layers(model.face(), residual=Moved([1, 0, 0]), targets=Doubled(), refinement=Moved([0, 3, 0])).head
    np.testing.assert_allclose(head.vertices, 2 * model.mean + np.array([2, 3, 0]), rtol=1e-5)


def test_a_displacement_gives_back_the_head_that_it_was_made_from(model):
    below, above = model.face(), model.face(expression="smile")
    np.testing.assert_allclose(Displacement.between(below, above).on(below).vertices, above.vertices, atol=1e-3)


def test_a_displacement_stays_where_the_head_below_stays(model):
    below, opened = model.face(), model.face(expression="jaw_drop")
    forehead = below.vertices[:, 1] > 70
    layer = Displacement(np.where(forehead[:, None], [0.0, 0.0, 30.0], 0.0))
    np.testing.assert_allclose(layer.on(opened).vertices - opened.vertices, layer.offsets, atol=1e-4)


@pytest.mark.parametrize("expression", ["surprise", "jaw_drop", "eyes_closed"])
def test_a_displacement_tears_nothing_when_the_head_below_changes_its_face(model, expression):
    """Lids and lips fold over; where they move a little, what lies far above them does not turn."""
    identity, rest, other = model.bilinear.identities[3], *(model.face(expression=e) for e in ("neutral", expression))
    below = model.face(identity)
    above = exaggerate(below, 2.0)
    changed = model.face(identity, rest.expression + 0.2 * (other.expression - rest.expression))
    moved = Displacement.between(below, above).on(changed)
    assert np.abs(moved.vertices - above.vertices).max() > 1
    assert turned_over(model, above.vertices, moved.vertices) == 0
