import pytest

from sketchwidget.sketch import COLOURS, FEATURES, LINE_NAMES, kind, mirrored


def test_every_line_has_a_kind_and_every_kind_a_colour():
    assert {kind(name) for name in LINE_NAMES} == set(COLOURS)


def test_the_papers_feature_lines_are_features():
    assert len(FEATURES) == 11
    assert {kind(name) for name in FEATURES} == {"feature"}


@pytest.mark.parametrize("name", ["chin", "", None, ["nose"]])
def test_an_unknown_line_is_an_error(name):
    with pytest.raises(ValueError, match="a line is one of"):
        kind(name)


def test_the_mirror_image_exchanges_left_and_right():
    assert mirrored("left_eye_upper") == "right_eye_upper"
    assert mirrored("right_brow") == "left_brow"
    assert mirrored("nose") == "nose"


@pytest.mark.parametrize("name", LINE_NAMES)
def test_mirroring_twice_gives_the_line_back(name):
    assert mirrored(name) in LINE_NAMES
    assert mirrored(mirrored(name)) == name
