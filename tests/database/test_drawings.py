"""Files of drawings: what is written is read, and what is no drawing is refused by file and line."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from sketchwidget import FaceModel, cli
from sketchwidget.database.drawings import (
    Drawing,
    append,
    merge,
    read_drawings,
    take_back,
    write_drawings,
)
from sketchwidget.files import records
from sketchwidget.sketch.pen import as_pen_stroke

MODEL = "0123456789abcdef" * 4
STROKE = np.array([[0.1, 0.2, 0.5, 0.0], [0.3, 0.4, 0.75, 8.3], [0.3, 0.5, 0.75, 16.6]])
DOT = np.array([[0.5, 0.5, 0.5, 0.0]])
HEADER = {"format": "sketchwidget drawings", "version": 1}


def drawing(shift=0.0, **changes):
    values = {"strokes": [np.add(STROKE, [shift, 0, 0, 0]), DOT], "identity": [0.1, -2.5], "expression": [1 / 3]}
    return Drawing(**{**values, "model": MODEL, **changes})


@pytest.fixture
def path(tmp_path):
    return tmp_path / "pupil.jsonl"


def written(path, *lines):
    path.write_text("".join(line if isinstance(line, str) else json.dumps(line) + "\n" for line in lines))
    return path


def test_what_is_written_is_read(path):
    given = [drawing(), drawing(0.2, view="left")]
    write_drawings(path, given)
    assert read_drawings(path) == given
    first = read_drawings(path)[0]
    np.testing.assert_allclose(first.strokes[0], STROKE, atol=1e-6)
    np.testing.assert_array_equal(first.expression, np.float32([1 / 3]))
    assert (first.view, first.model) == ("front", MODEL)


def test_a_file_is_a_header_and_a_drawing_a_line(path):
    write_drawings(path, [drawing()])
    header, line = map(json.loads, path.read_text().splitlines())
    assert header == HEADER
    assert line["strokes"][0][1] == [0.3, 0.4, 0.75, 8.3]


def test_drawings_are_added_one_by_one(path):
    given = [drawing(), drawing(0.1), drawing(0.2)]
    for one in given:
        append(path, one)
        assert read_drawings(path)[-1] == one
    assert read_drawings(path) == given


def test_a_drawing_is_a_sketch_and_keeps_the_weights_of_its_face():
    model = FaceModel.load()
    face = model.face(model.bilinear.identities[2], model.bilinear.expressions[1])
    made = Drawing.of(face, [STROKE], "left")
    assert made.model == model.fingerprint and made.view == "left"
    np.testing.assert_array_equal(made.identity, face.identity)
    np.testing.assert_allclose(made.sketch.segments[0].points, STROKE[:, :2], atol=1e-6)


def test_a_face_without_weights_has_no_drawing():
    model = FaceModel.load()
    with pytest.raises(ValueError, match="this face has none"):
        Drawing.of(type(model.face())(model, model.mean), [STROKE])


def test_a_file_cut_short_in_its_last_line_loses_only_that_drawing(path):
    write_drawings(path, [drawing()])
    whole = path.read_bytes()
    write_drawings(path, [drawing(), drawing(0.1)])
    both = path.read_bytes()
    for size in range(len(whole) + 1, len(both) - 1, 7):
        path.write_bytes(both[:size])
        with pytest.warns(UserWarning, match=r"last drawing in .*pupil.jsonl was cut short"):
            assert read_drawings(path) == [drawing()]
        with pytest.warns(UserWarning, match="cut short"):
            append(path, drawing(0.2))
        assert read_drawings(path) == [drawing(), drawing(0.2)]


def test_a_last_line_that_only_lacks_its_end_is_whole(path):
    write_drawings(path, [drawing(), drawing(0.1)])
    path.write_bytes(path.read_bytes()[:-1])
    assert read_drawings(path) == [drawing(), drawing(0.1)]
    append(path, drawing(0.2))
    assert len(read_drawings(path)) == 3


def test_lines_may_end_as_on_windows(path):
    write_drawings(path, [drawing()])
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    assert read_drawings(path) == [drawing()]


GOOD = {"view": "front", "model": MODEL, "identity": [0.0], "expression": [0.0], "strokes": [[[0, 0, 0, 0]]]}


@pytest.mark.parametrize(
    ("lines", "complaint"),
    [
        ([], "holds no drawings"),
        (["\x00\xff"], "holds no drawings"),
        (["[" * 100_000 + "\n"], "holds no drawings"),
        ([{**HEADER, "format": "sketchwidget session"}], "holds no drawings"),
        ([{**HEADER, "version": 2}], "of version 2; this sketchwidget reads version 1"),
        ([HEADER, "\n"], "line 2 is no JSON"),
        ([HEADER, GOOD, "{\n", GOOD], "line 3 is no JSON"),
        ([HEADER, GOOD, []], "line 3 is no drawing"),
        ([HEADER, {**GOOD, "pupil": "me"}], "line 2 is no drawing: it is an object of strokes, identity"),
        ([HEADER, {**GOOD, "view": "right"}], "line 2 is no drawing: a head is drawn in the view front or left"),
        ([HEADER, {**GOOD, "model": "shipped"}], "fingerprint"),
        ([HEADER, {**GOOD, "model": None}], "fingerprint"),
        ([HEADER, {**GOOD, "identity": []}], "identity weights"),
        ([HEADER, {**GOOD, "identity": [1e300]}], "identity weights"),
        ([HEADER, {**GOOD, "expression": [float("nan")]}], "expression weights"),
        ([HEADER, {**GOOD, "expression": [True]}], "expression weights"),
        ([HEADER, {**GOOD, "expression": [10**400, 0.5]}], "expression weights"),
        ([HEADER, {**GOOD, "expression": [[0.0], 1.0]}], "expression weights"),
        ([HEADER, {**GOOD, "strokes": []}], "1 to 2,000 strokes; given 0"),
        ([HEADER, {**GOOD, "strokes": None}], "1 to 2,000 strokes; given NoneType"),
        ([HEADER, {**GOOD, "strokes": [[[0, 0, 0, 0]]] * 2001}], "1 to 2,000 strokes; given 2,001"),
        ([HEADER, {**GOOD, "strokes": [5]}], r"four numbers.*given shape \(\)"),
        ([HEADER, {**GOOD, "strokes": [[]]}], "four numbers"),
        ([HEADER, {**GOOD, "strokes": [[[0, 0]]]}], r"four numbers.*given shape \(1, 2\)"),
        ([HEADER, {**GOOD, "strokes": [[[0, 0, 0, 0], [0, 0]]]}], "four numbers"),
        ([HEADER, {**GOOD, "strokes": [[[10**400, 0.5, 0, 0]]]}], "four numbers"),
        ([HEADER, {**GOOD, "strokes": [[["0", "0", "0", "0"]]]}], "four numbers.*given <U1 values"),
        ([HEADER, {**GOOD, "strokes": [[[3, 0, 0, 0]]]}], r"within \[-1, 2\].*given \[3, 0, 0, 0\] as point 0"),
        ([HEADER, {**GOOD, "strokes": [[[float("nan"), 0, 0, 0]]]}], r"within \[-1, 2\]"),
        ([HEADER, {**GOOD, "strokes": [[[0, 0, 1.5, 0]]]}], r"pressure.*given \[0.0, 0.0, 1.5, 0.0\] as point 0"),
        (
            [HEADER, {**GOOD, "strokes": [[[0, 0, 0, 5], [0, 0, 0, 4]]]}],
            r"decrease; given \[0, 0, 0, 4\] as point 1",
        ),
        ([HEADER, {**GOOD, "strokes": [[[0, 0, 0, float("inf")]]]}], "never decrease"),
        ([HEADER, {**GOOD, "strokes": [[[0, 0, 0, -1]]]}], "never decrease"),
    ],
)
def test_a_file_that_holds_something_else_is_refused_by_name_and_line(path, lines, complaint):
    with pytest.raises(ValueError, match=rf"pupil\.jsonl.*{complaint}"):
        read_drawings(written(path, *lines))


def test_a_file_of_something_else_is_not_added_to(path):
    path.write_text("Dear reader\n")
    with pytest.raises(ValueError, match="holds no drawings"):
        append(path, drawing())
    assert path.read_text() == "Dear reader\n"


def test_files_and_lines_are_bounded(path, monkeypatch):
    write_drawings(path, [drawing()])
    monkeypatch.setattr(records, "MAX_LINE", 100)
    with pytest.raises(ValueError, match=r"pupil\.jsonl, line 2 is longer"):
        read_drawings(path)
    monkeypatch.undo()
    monkeypatch.setattr(records, "MAX_BYTES", path.stat().st_size + 10)
    with pytest.raises(ValueError, match="would be larger"):
        append(path, drawing(0.1))
    with pytest.raises(ValueError, match="would be larger"):
        write_drawings(path, [drawing(), drawing(0.1)])
    assert read_drawings(path) == [drawing()]
    assert [file.name for file in path.parent.iterdir()] == [path.name]
    monkeypatch.setattr(records, "MAX_BYTES", 100)
    with pytest.raises(ValueError, match="is larger than"):
        read_drawings(path)


def test_strokes_are_rounded_as_they_are_written():
    once = as_pen_stroke([[0.123456789, 1 / 3, 1 / 3, 1 / 3]])
    np.testing.assert_allclose(once, [[0.12346, 0.33333, 0.333, 0.3]], atol=1e-7)
    np.testing.assert_array_equal(as_pen_stroke(once), once)
    assert not once.flags.writeable


def test_a_long_stroke_keeps_its_time_to_a_tenth(path):
    times = np.arange(999_000.0, 1_000_000.0, 0.7)
    stroke = np.column_stack([np.zeros((len(times), 3)), times])
    append(path, drawing(strokes=[stroke]))
    np.testing.assert_allclose(read_drawings(path)[0].strokes[0][:, 3], np.round(times, 1), atol=0.04)
    assert read_drawings(path) == [drawing(strokes=[stroke])]


def test_the_last_drawing_can_be_taken_back(path):
    append(path, drawing())
    append(path, drawing(0.1))
    with pytest.raises(ValueError, match="another drawing"):
        take_back(path, drawing())
    take_back(path, drawing(0.1))
    assert read_drawings(path) == [drawing()]
    take_back(path, drawing())
    with pytest.raises(ValueError, match="another drawing"):
        take_back(path, drawing())
    assert read_drawings(path) == []


def test_merging_keeps_the_order_and_drops_what_is_equal(tmp_path):
    a, b, out = (tmp_path / f"{name}.jsonl" for name in ("a", "b", "out"))
    write_drawings(a, [drawing(), drawing(0.1), drawing()])
    write_drawings(b, [drawing(0.1), drawing(0.1, view="left"), drawing(0.2)])
    assert merge([a, b], out) == (4, 2)
    assert read_drawings(out) == [drawing(), drawing(0.1), drawing(0.1, view="left"), drawing(0.2)]


def test_merging_overwrites_no_file_but_one_of_its_own(tmp_path):
    a, b = tmp_path / "a.jsonl", tmp_path / "b.jsonl"
    write_drawings(a, [drawing()])
    write_drawings(b, [drawing(0.1)])
    with pytest.raises(FileExistsError, match=r"a\.jsonl exists"):
        merge([b], a)
    assert read_drawings(a) == [drawing()]
    assert merge([a, b], a) == (2, 0)
    assert read_drawings(a) == [drawing(), drawing(0.1)]


def run(*arguments):
    return CliRunner().invoke(cli.main, ["drawings", "merge", *map(str, arguments)])


def test_the_command_merges(tmp_path):
    a, b, out = (tmp_path / f"{name}.jsonl" for name in ("a", "b", "out"))
    write_drawings(a, [drawing()])
    write_drawings(b, [drawing(), drawing(0.1)])
    b.write_bytes(b.read_bytes()[:-9])  # its second drawing is cut short
    result = run(out, a, b)
    assert result.exit_code == 0
    assert "out.jsonl: 1 of 2 drawings; the others are equal to one of these" in result.stdout
    assert "b.jsonl was cut short" in result.stderr
    assert read_drawings(out) == [drawing()]


@pytest.mark.parametrize(
    ("content", "complaint"),
    [(None, "No such file"), ("Dear reader\n", "holds no drawings"), (json.dumps(HEADER) + "\n{}\n", "line 2")],
)
def test_the_command_ends_with_a_message_where_it_cannot_merge(tmp_path, content, complaint):
    a = tmp_path / "a.jsonl"
    if content is not None:
        a.write_text(content)
    result = run(tmp_path / "out.jsonl", a)
    assert result.exit_code == 1
    assert complaint in result.stderr and "a.jsonl" in result.stderr and "Traceback" not in result.stderr
    assert not (tmp_path / "out.jsonl").exists()
