"""What the page is told of a rig, added up here as the page does."""

import gzip
from types import SimpleNamespace

import numpy as np
import pytest
import pythreejs as three

from sketchwidget.avatar import Performance
from sketchwidget.avatar.eyes import TURNS
from sketchwidget.widgets.puppet import Puppet, grouped


class Head:
    """Five vertices, two expressions."""

    face = SimpleNamespace(vertices=np.arange(15, dtype=np.float32).reshape(5, 3))
    rig = {
        "jawOpen": np.array([[0, 0, 0], [0, -20.5, 1], [0, 0, 0], [0, 0, 0], [3, 0, 0]], dtype=np.float32),
        "eyeBlinkLeft": np.zeros((5, 3), dtype=np.float32),
    }
    eyes = (SimpleNamespace(side="left", vertices=np.array([2, 3]), centre=np.array([1.0, 2, 3])),)


@pytest.fixture
def puppet():
    return Puppet(geometry=three.BufferGeometry())


def test_the_rig_is_sent_once_and_again_to_a_page_that_is_ready(puppet, sent):
    messages = sent(puppet)
    puppet.hold(Head(), [Performance("nod", np.array([0.0, 1.0]), {"jawOpen": np.array([0.0, 1.0])})])
    (content, (packed,)) = messages[0]
    assert content["counts"] == {"jawOpen": 2, "eyeBlinkLeft": 0}
    assert content["eyes"][0]["turns"] == TURNS and content["eyes"][0]["gaze"][0] == "eyeLookUpLeft"
    data = gzip.decompress(packed)
    np.testing.assert_array_equal(np.frombuffer(data, "<f4", 15).reshape(5, 3), Head.face.vertices)
    vertices = np.cumsum(np.frombuffer(data, "<u2", 2, 60))
    steps = np.frombuffer(data, "<i2", 6, 64).reshape(3, 2).T * content["step"]
    np.testing.assert_array_equal(vertices, [1, 4])
    np.testing.assert_allclose(steps, Head.rig["jawOpen"][vertices], atol=content["step"] / 2)
    np.testing.assert_array_equal(np.frombuffer(data, "<u2", 2, 76), [2, 3])
    assert len(data) == 80
    assert puppet.performances == {"nod": {"times": [0.0, 1.0], "weights": {"jawOpen": [0.0, 1.0]}}}
    puppet._handle_custom_msg({"type": "ready"}, [])
    assert messages[1][0] == content


def test_a_head_let_go_is_at_rest_and_not_sent_again(puppet, sent):
    puppet.hold(Head())
    puppet.weights = {"jawOpen": 1.0}
    messages = sent(puppet)
    puppet.hold(None)
    assert [content["type"] for content, _ in messages] == ["release"] and puppet.weights == {} and puppet.names == []
    puppet._handle_custom_msg({"type": "ready"}, [])
    assert len(messages) == 1


def test_a_driver_is_any_iterable_of_weights(puppet):
    shown = []
    puppet.observe(lambda change: shown.append(change["new"]), "weights")
    puppet.drive(({"jawOpen": share} for share in (0.5, 0.25)), rate=None)
    puppet.drive([{"jawOpen": 1}], rate=1000)
    assert shown == [{"jawOpen": 0.5}, {"jawOpen": 0.25}, {"jawOpen": 1.0}]
    with pytest.raises(ValueError, match="frames a second"):
        puppet.drive([{}], rate=0)


def test_every_expression_is_in_one_group():
    names = ["jawOpen", "noseSneerLeft", "browDownLeft", "eyeBlinkLeft", "tongueOut", "mouthClose"]
    groups = grouped(names)
    assert sorted(name for _, members in groups for name in members) == sorted(names)
    assert dict(groups)["Jaw"] == ["jawOpen"]


def test_a_move_too_large_for_its_bytes_is_told(puppet):
    head = Head()
    head.rig = {"jawOpen": np.full((5, 3), 400.0)}
    with pytest.raises(ValueError, match="328 mm"):
        puppet.hold(head)
    assert puppet.names == [] and puppet._rig is None  # nothing of it is there
