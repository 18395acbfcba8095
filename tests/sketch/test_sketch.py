import json
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from sketchwidget.sketch import COLOURS, LINE_NAMES, Segment, Sketch
from sketchwidget.sketch.sketch import MAX_STROKES

LINE = np.array([[0.1, 0.2], [0.3, 0.4]])

segments = st.builds(
    Segment,
    st.sampled_from(LINE_NAMES),
    hnp.arrays(np.float32, st.tuples(st.integers(1, 5), st.just(2)), elements=st.floats(-1, 2, width=32)),
)
sketches = st.lists(segments, max_size=5).map(lambda drawn: Sketch(tuple(drawn)))


@pytest.fixture
def face():
    return Sketch(
        (
            Segment("nose", LINE),
            Segment("silhouette", LINE + 0.1),
            Segment("nose", [[0.5, 0.5]]),
            Segment("wrinkle", LINE),
        )
    )


def test_lines_group_segments_in_drawing_order(face):
    assert list(face.lines) == ["nose", "silhouette", "wrinkle"]
    assert [len(points) for points in face.lines["nose"]] == [2, 1]


def test_a_segment_is_added_and_renamed(face):
    more = face.with_segment("left_ear", LINE)
    assert len(more) == 5
    assert more.segments[:4] == face.segments and more.segments[4].name == "left_ear"
    assert [segment.name for segment in face.renamed(["unnamed"] * 4).segments] == ["unnamed"] * 4
    assert face.renamed(["nose", "silhouette", "nose", "wrinkle"]) == face


def test_changes_share_the_points(face):
    assert face.renamed(["nose"] * 4).segments[1].points is face.segments[1].points
    assert face.with_segment("nose", LINE).segments[0] is face.segments[0]


def test_a_change_that_cannot_be_is_an_error(face):
    with pytest.raises(ValueError, match="takes as many names; given 1"):
        face.renamed(["nose"])
    with pytest.raises(ValueError, match="a line is one of"):
        face.renamed(["chin"] * 4)
    with pytest.raises(ValueError, match="stroke"):
        face.with_segment("nose", [])


def test_points_cannot_be_changed(face):
    with pytest.raises(ValueError, match="read-only"):
        face.segments[0].points[0] = 0


def test_sketches_are_compared_by_value(face):
    same = Sketch(tuple(Segment(s.name, s.points.copy()) for s in face.segments))
    assert same == face
    assert hash(same) == hash(face)
    assert Sketch(face.segments[1:]) != face
    assert face != "face"


def test_strokes_on_the_canvas_stay_where_they_are():
    strokes = [LINE, [[-0.2, 0.5], [1.2, 0.5]]]
    sketch = Sketch.from_strokes(strokes)
    for points, stroke in zip(sketch.lines["unnamed"], strokes, strict=True):
        np.testing.assert_allclose(points, stroke, rtol=1e-6)


def test_strokes_of_another_frame_are_fitted_together():
    # 400 x 200 pixels: 0.8 wide, 0.4 high, in the middle.
    sketch = Sketch.from_strokes([[[100, 100], [500, 100]], [[300, 300]]])
    np.testing.assert_allclose(sketch.segments[0].points, [[0.1, 0.3], [0.9, 0.3]], rtol=1e-5)
    np.testing.assert_allclose(sketch.segments[1].points, [[0.5, 0.7]], rtol=1e-5)


def test_a_dot_of_another_frame_lands_in_the_middle():
    np.testing.assert_allclose(Sketch.from_strokes([[[300, 200]]]).segments[0].points, [[0.5, 0.5]])


def test_no_strokes_are_an_empty_sketch():
    assert Sketch.from_strokes([]) == Sketch()
    assert len(Sketch()) == 0
    assert not Sketch().image().any()


@given(st.floats(1, 1e6), st.floats(-1e6, 1e6))
def test_fitting_ignores_the_frame(scale, shift):
    drawing = np.array([[0.0, 0.0], [2.0, 1.0], [1.0, 3.0]])
    fitted = Sketch.from_strokes([1e4 * drawing]).segments[0].points
    again = Sketch.from_strokes([1e4 * drawing * scale + shift]).segments[0].points
    np.testing.assert_allclose(again, fitted, atol=1e-5)


def test_there_are_at_most_20000_strokes():
    segment = Segment("unnamed", LINE)
    assert len(Sketch((segment,) * MAX_STROKES)) == MAX_STROKES
    with pytest.raises(ValueError, match="at most 20,000 strokes; given 20,001"):
        Sketch((segment,) * (MAX_STROKES + 1))


def test_a_bad_stroke_is_an_error():
    with pytest.raises(ValueError, match="finite"):
        Sketch.from_strokes([LINE, [[np.nan, 0]]])


def test_the_image_is_square_and_has_the_ink(face):
    image = face.image(64)
    assert image.shape == (64, 64)
    assert image.dtype == bool
    assert image[32, 32]


def test_a_picture_has_each_line_in_the_colour_of_its_kind():
    across = np.array([[0.2, 0.25], [0.8, 0.25]])
    sketch = Sketch((Segment("nose", across), Segment("wrinkle", across + np.array([0, 0.5]))))
    picture = sketch.picture(500)
    assert picture.shape == (500, 500, 3) and picture.dtype == np.uint8
    np.testing.assert_array_equal(picture[[125, 375, 250], 250], [[0x1F, 0x5F, 0xD0], [0, 0, 0], [255, 255, 255]])
    inked = (picture < 255).any(axis=2)
    assert inked[sketch.image(500)].all() and not inked[[0, -1]].any()
    np.testing.assert_array_equal(Sketch().picture(8), np.full((8, 8, 3), 255))


def test_svg_has_each_segment_in_the_colour_of_its_kind(face):
    lines = ElementTree.fromstring(face.svg()).findall(".//{*}polyline")
    kinds = ["feature", "silhouette", "feature", "wrinkle"]
    assert [line.get("stroke") for line in lines] == [COLOURS[kind] for kind in kinds]
    assert lines[0].get("points") == "0.1,0.2 0.3,0.4"
    assert lines[2].get("points") == "0.5,0.5 0.5,0.5"


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(sketches)
def test_a_saved_sketch_loads_equal(tmp_path, sketch):
    sketch.save(tmp_path / "sketch.json")
    assert Sketch.load(tmp_path / "sketch.json") == sketch


def document(**changes):
    segment = {"name": "nose", "points": [[0.1, 0.2]]}
    return {"format": "sketchwidget sketch", "version": 1, "segments": [segment], **changes}


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (b"", "no sketch"),
        (b"\x89PNG\xff", "not text"),
        (b"{" * 100_000, "no sketch"),
        (b"[" * 100_000, "recursion"),
        (b"[]", '"format"'),
        (json.dumps(document(format="other")), '"format"'),
        (json.dumps(document(version=2)), "version is 2"),
        (json.dumps(document(segments={})), "no list"),
        (json.dumps(document(segments=[3])), "segment 0 is not an object"),
        (json.dumps(document(segments=[{"name": "nose"}])), "segment 0 is not an object"),
        (json.dumps(document(segments=[{"name": "chin", "points": [[0, 0]]}])), "segment 0: a line is one of"),
        (json.dumps(document(segments=[{"name": ["nose"], "points": [[0, 0]]}])), "segment 0: a line is one of"),
        (json.dumps(document(segments=[{"name": "nose", "points": [[0, np.nan]]}])), "segment 0: a stroke"),
        (json.dumps(document(segments=[{"name": "nose", "points": []}])), "segment 0: a stroke"),
    ],
)
def test_a_file_that_is_no_sketch_is_an_error_that_says_why(tmp_path, content, complaint):
    path = tmp_path / "sketch.json"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(ValueError, match=complaint):
        Sketch.load(path)


def test_a_sketch_file_cut_short_is_an_error(tmp_path, face):
    path = tmp_path / "sketch.json"
    face.save(path)
    content = path.read_bytes()
    for size in range(len(content.rstrip())):
        path.write_bytes(content[:size])
        with pytest.raises(ValueError, match="no sketch"):
            Sketch.load(path)
