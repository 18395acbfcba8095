import pytest

from sketchwidget.sketch import COLOURS, FEATURES, LINE_NAMES, kind


def test_every_line_has_a_kind_and_every_kind_a_colour():
    assert {kind(name) for name in LINE_NAMES} == set(COLOURS)


def test_the_papers_feature_lines_are_features():
    assert len(FEATURES) == 11
    assert {kind(name) for name in FEATURES} == {"feature"}


@pytest.mark.parametrize("name", ["chin", "", None, ["nose"]])
def test_an_unknown_line_is_an_error(name):
    with pytest.raises(ValueError, match="a line is one of"):
        kind(name)
