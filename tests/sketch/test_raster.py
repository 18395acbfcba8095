import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from sketchwidget.sketch import rasterise


def test_a_thin_horizontal_line():
    # From the centre of pixel (5, 4) to that of pixel (5, 11).
    image = rasterise([np.array([[4.5, 5.5], [11.5, 5.5]]) / 16], size=16)
    expected = np.zeros((16, 16), dtype=bool)
    expected[5, 4:12] = True
    np.testing.assert_array_equal(image, expected)


def test_a_thin_diagonal():
    np.testing.assert_array_equal(
        rasterise([np.array([[0.5, 0.5], [15.5, 15.5]]) / 16], size=16), np.eye(16, dtype=bool)
    )


def test_a_dot_has_ink_about_it():
    rows, columns = np.nonzero(rasterise([np.array([[0.3, 0.7]])]))
    np.testing.assert_allclose([columns.mean() / 256, rows.mean() / 256], [0.3, 0.7], atol=0.005)


def test_nothing_drawn_is_a_blank_image():
    assert not rasterise([]).any()
    assert rasterise([]).shape == (256, 256)


def test_a_line_through_the_canvas_is_cut_at_its_border():
    image = rasterise([np.array([[-30.0, 0.5], [30.0, 0.5]])])
    assert image.any(axis=0).all()
    assert not image[:120].any()


def test_a_line_off_the_canvas_leaves_it_blank():
    assert not rasterise([np.array([[1.5, -1.0], [1.5, 2.0]])]).any()
    assert not rasterise([np.array([[1e30, 1e30]])]).any()


def test_bad_input_is_an_error():
    with pytest.raises(ValueError, match="finite"):
        rasterise([np.array([[np.nan, 0.5]])])
    with pytest.raises(ValueError, match="pixels"):
        rasterise([], size=0)


@given(
    hnp.arrays(np.float32, (5, 2), elements=st.floats(-1, 2, width=32)),
    hnp.arrays(np.float32, (3, 2), elements=st.floats(-1, 2, width=32)),
)
def test_a_drawing_is_the_union_of_its_lines(first, second):
    np.testing.assert_array_equal(rasterise([first, second]), rasterise([first]) | rasterise([second]))
