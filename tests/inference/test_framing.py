"""Where a head stands in a drawing, by their outlines."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import KDTree

from sketchwidget import FaceModel
from sketchwidget.face.drawing import outline
from sketchwidget.geometry import View
from sketchwidget.geometry.view import CANVAS_MM
from sketchwidget.inference.framing import Frame, place
from sketchwidget.sketch import SILHOUETTE, resample

HEAD = outline(View().project(FaceModel.load().face().curve(SILHOUETTE)))
scales, places = st.floats(0.4, 1.3), st.floats(-0.3, 0.3)


def put(points, scale, offset):
    """Canvas points of the canonical front view where the head stands elsewhere."""
    return scale * (points - 0.5) + 0.5 + np.array(offset)


@given(scale=scales, x=places, y=places)
def test_a_head_s_own_outline_is_found_where_it_is_drawn(scale, x, y):
    view = place(HEAD, put(HEAD, scale, (x, y)))
    assert view.scale * CANVAS_MM == pytest.approx(scale, abs=1e-6)
    np.testing.assert_allclose(view.centre, [0.5 + x, 0.5 + y], atol=1e-6)


@given(
    scale=scales,
    x=places,
    y=places,
    width=st.floats(0.8, 0.92) | st.floats(1.08, 1.25),
    open_from=st.floats(0.0, 0.5),
)
def test_another_outline_is_nearer_than_where_placing_began(scale, x, y, width, open_from):
    shape = 0.5 + (HEAD[:-1] - 0.5) * [width, 1.0]
    height = np.ptp(shape[:, 1])
    top = shape[:, 1] < shape[:, 1].min() + open_from * height  # left out, as of a jaw drawn as a U
    drawn = put(shape[~top], scale, (x, y))

    def squares(scale, centre):
        return np.square(KDTree(put(HEAD, scale, np.array(centre) - 0.5)).query(drawn)[0]).sum()

    view = place(HEAD, drawn)
    wide = np.ptp(drawn[:, 0]) / np.ptp(HEAD[:, 0])
    middle = (drawn[:, 0].max() + drawn[:, 0].min() - wide * (HEAD[:, 0].max() + HEAD[:, 0].min() - 1)) / 2
    chin = drawn[:, 1].max() - wide * (HEAD[:, 1].max() - 0.5)
    assert squares(view.scale * CANVAS_MM, view.centre) < 0.99 * squares(wide, (middle, chin))


@given(scale=scales, x=places, y=places)
def test_a_drawing_s_frame_undoes_its_place_and_size(scale, x, y):
    moved = put(HEAD, scale, (x, y))
    np.testing.assert_allclose(Frame.of_outline(moved)(moved), Frame.of_outline(HEAD)(HEAD), atol=1e-6)


def test_what_has_no_height_is_no_outline():
    with pytest.raises(ValueError, match="width and height"):
        Frame.of_outline(resample(np.array([[0.2, 0.5], [0.8, 0.5]]), 10))
