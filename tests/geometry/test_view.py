"""The camera: millimetres to the canvas."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget.geometry import View, rotation_about_y


def test_front_view_puts_a_200_mm_face_on_four_fifths_of_the_canvas():
    ends = View().project(np.array([[0, 100, 0], [0, -100, 0], [25, 0, 80]]))
    np.testing.assert_allclose(ends, [[0.5, 0.1], [0.5, 0.9], [0.6, 0.5]], atol=1e-6)


@pytest.mark.parametrize(("name", "nose_x"), [("front", 0.5), ("left", 0.1), ("right", 0.9)])
def test_presets_turn_the_nose_where_that_side_looks(name, nose_x):
    assert View.preset(name).project(np.array([0, 0, 100]))[0] == pytest.approx(nose_x, abs=1e-6)


def test_three_quarter_shows_the_face_between_front_and_side():
    assert 0.1 < View.preset("three-quarter").project(np.array([0, 0, 100]))[0] < 0.5


@given(st.floats(-360, 360))
def test_rotation_keeps_lengths_and_the_upward_axis(degrees):
    rotation = rotation_about_y(degrees)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-6)
    np.testing.assert_allclose(rotation @ [0, 1, 0], [0, 1, 0], atol=1e-7)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ({"rotation": np.ones((3, 3))}, "orthonormal"),
        ({"scale": 0}, "positive"),
        ({"scale": np.nan}, "positive"),
        ({"centre": [0.5]}, "finite point"),
        ({"centre": [np.inf, 0]}, "finite point"),
    ],
)
def test_bad_views_are_refused(arguments, complaint):
    with pytest.raises(ValueError, match=complaint):
        View(**arguments)


def test_unknown_preset_is_named():
    with pytest.raises(ValueError, match="'back'"):
        View.preset("back")


@pytest.mark.parametrize("name", ["front", "left", "right", "three-quarter"])
def test_a_view_of_the_head_has_room_for_its_neck(model, name):
    head, canonical = View.of_head(name).project(model.mean), View.preset(name).project(model.mean)
    assert head.min() > 0.05 and head.max() < 0.95 < canonical.max()
