import contextlib
import io

import numpy as np
import pytest
from PIL import Image

from sketchwidget.widgets.picture_pad import LONGEST, PicturePad


@pytest.fixture
def pad():
    return PicturePad()


def test_a_wide_picture_is_shown_whole_in_the_middle_of_a_square(pad):
    pad.show_picture(np.zeros((100, 200, 3), dtype=np.uint8))
    assert pad.size == [200, 100] and pad.part == [0, -50, 200]
    assert (pad.canvas.width, pad.canvas.height) == (200, 100)
    pad.show_picture(None)
    assert pad.size == [0, 0]


def test_a_large_picture_goes_to_the_page_smaller(pad):
    pad.show_picture(np.zeros((2000, 1000, 3), dtype=np.uint8))
    assert pad.size == [1000, 2000] and pad.canvas.height == LONGEST
    assert Image.open(io.BytesIO(pad._image.value)).size == (LONGEST // 2, LONGEST)


def test_the_part_about_the_points_is_shown(pad):
    pad.show_picture(np.zeros((1000, 1000, 3), dtype=np.uint8))
    pad.look_at(np.array([[100, 200], [200, 300]]))
    left, top, side = pad.part
    assert 100 < side < 200 and left + side / 2 == 150 and top + side / 2 == 250
    pad.look_at(np.array([[0, 0], [1000, 900]]))
    assert pad.part[2] == 1000


def test_moves_are_told_and_answered_even_if_they_fail(pad, sent):
    told, answers = [], sent(pad)

    def fails(*move):
        told.append(move)
        raise RuntimeError("no")

    pad.on_move(fails)
    with contextlib.suppress(RuntimeError):
        pad._receive(pad, {"type": "move", "move": "a-1", "number": 3, "place": [1.5, 2], "done": True}, [])
    ((number, place, done),) = told
    assert number == 3 and place.tolist() == [1.5, 2] and done is True
    assert answers == [({"type": "answer", "move": "a-1"}, None)]
