import base64
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sketchwidget.face import FaceModel
from sketchwidget.session.packed import MAX_VERTICES, pack, rounded, unpack


@given(arrays(np.float64, st.tuples(st.integers(1, 40), st.just(3)), elements=st.floats(-2000, 2000)))
def test_packed_vertices_come_back_bit_for_bit(vertices):
    kept = rounded(vertices)
    np.testing.assert_allclose(kept, vertices, atol=0.0051)
    assert unpack(pack(kept)).tobytes() == kept.tobytes() == rounded(kept).tobytes()


def test_a_head_takes_about_a_hundred_kilobytes():
    assert len(pack(rounded(FaceModel.load().face(expression="smile").vertices))) < 130_000


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        (None, "a head has"),
        ("face", "a head has"),
        (np.zeros((0, 3)), r"shape \(0, 3\)"),
        (np.zeros((4, 2)), r"shape \(4, 2\)"),
        (np.zeros((MAX_VERTICES + 1, 3)), "200,000 vertices"),
        ([[0, 0, np.nan]], "not finite"),
        ([[0, 0, 2001]], "further away"),
    ],
)
def test_what_is_no_head_is_refused(given, complaint):
    with pytest.raises(ValueError, match=complaint):
        rounded(given)


def test_a_bomb_is_refused_before_it_is_decompressed():
    bomb = base64.b64encode(zlib.compress(bytes(64 * 2**20), 9)).decode()
    with pytest.raises(ValueError, match="more than 200,000"):
        unpack(bomb)
    with pytest.raises(ValueError, match="characters"):
        unpack("A" * (5 * 2**20))


@pytest.mark.parametrize("text", ["", "?", "AAAA", pack(rounded(np.ones((5, 3))))[:-8], "eJwDAAAAAAE="])
def test_other_text_is_refused(text):
    with pytest.raises(ValueError, match=r"no packed vertices: (damaged|cut short)|shape \(0, 3\)"):
        unpack(text)
