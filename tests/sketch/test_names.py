import pytest

from sketchwidget.sketch import COLOURS, FEATURES, LINE_NAMES, Sketch, kind, register_line


def test_every_line_has_a_kind_and_every_kind_a_colour():
    assert {kind(name) for name in LINE_NAMES} == set(COLOURS)


def test_the_papers_feature_lines_are_features():
    assert len(FEATURES) == 11
    assert {kind(name) for name in FEATURES} == {"feature"}


@pytest.mark.parametrize("name", ["chin", "", None, ["nose"]])
def test_an_unknown_line_is_an_error(name):
    with pytest.raises(ValueError, match="a line is one of"):
        kind(name)


def test_an_added_line_is_a_kind_of_its_own_in_its_colour(lines_restored):
    register_line("moustache", "#8a5a00")
    register_line("moustache", "#00ff00")  # and may get another
    drawing = Sketch.from_strokes([[[0.4, 0.6], [0.6, 0.6]]]).renamed(["moustache"])
    assert kind("moustache") == "moustache"
    assert "#00ff00" in drawing.svg()
    assert list(drawing.lines) == ["moustache"]


@pytest.mark.parametrize("name", ["nose", "silhouette", "unnamed", "feature", "", "a b", '"/><script>', None, 3])
def test_a_line_that_is_added_has_a_name_of_its_own(lines_restored, name):
    with pytest.raises(ValueError, match="a name of its own"):
        register_line(name, "#8a5a00")


@pytest.mark.parametrize("colour", ["brown", "#8a5a0", '#8a5a00"/>', None, 8])
def test_its_colour_is_written_in_hexadecimal(lines_restored, colour):
    with pytest.raises(ValueError, match="#rrggbb"):
        register_line("moustache", colour)
    assert "moustache" not in COLOURS
