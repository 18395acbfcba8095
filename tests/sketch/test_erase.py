from itertools import pairwise

import cv2
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from sketchwidget.sketch import Segment, Sketch, erase, resample
from sketchwidget.sketch.erase import first_touched

coordinates = st.floats(0, 1, width=32)
strokes = hnp.arrays(np.float32, st.tuples(st.integers(1, 8), st.just(2)), elements=coordinates)
paths = hnp.arrays(np.float32, st.tuples(st.integers(1, 4), st.just(2)), elements=coordinates)
drawings = st.lists(strokes, min_size=1, max_size=4)
radii = st.floats(0.002, 0.5)


def distance_to_path(points, path):
    """By a dense sampling of the path: no better than 1e-3, and unrelated to how erasing computes it."""
    path = path if len(path) > 1 else np.repeat(path, 2, axis=0)
    t = np.linspace(0, 1, 1500)[:, None]
    samples = np.concatenate([(1 - t) * a + t * b for a, b in pairwise(path)])
    return np.array([np.hypot(*(samples - point).T).min() for point in points])


def test_a_click_splits_a_straight_stroke_at_the_rim():
    sketch = Sketch((Segment("nose", [[0.1, 0.5], [0.9, 0.5]]), Segment("wrinkle", [[0.2, 0.1], [0.3, 0.1]])))
    erased = erase(sketch, [[0.5, 0.5]], 0.1)
    assert [segment.name for segment in erased.segments] == ["nose", "nose", "wrinkle"]
    np.testing.assert_allclose(erased.segments[0].points, [[0.1, 0.5], [0.4, 0.5]], rtol=1e-6)
    np.testing.assert_allclose(erased.segments[1].points, [[0.6, 0.5], [0.9, 0.5]], rtol=1e-6)
    assert erased.segments[2] is sketch.segments[1]


def test_a_pass_beside_a_stroke_takes_what_lies_in_its_strip():
    # The rim runs at y = 0.1; the stroke dips below it between x = 0.4 and x = 0.6.
    sketch = Sketch.from_strokes([[[0.3, 0.2], [0.5, 0.0], [0.7, 0.2]]])
    erased = erase(sketch, [[0.0, 0.0], [1.0, 0.0]], 0.1)
    assert len(erased) == 2
    np.testing.assert_allclose(erased.segments[0].points, [[0.3, 0.2], [0.4, 0.1]], rtol=1e-6)
    np.testing.assert_allclose(erased.segments[1].points, [[0.6, 0.1], [0.7, 0.2]], rtol=1e-6)


def test_a_stroke_under_the_eraser_goes_and_a_dot_does():
    sketch = Sketch.from_strokes([[[0.5, 0.5], [0.52, 0.5]], [[0.5, 0.45]], [[0.5, 0.3]]])
    assert erase(sketch, [[0.5, 0.5]], 0.1).segments == sketch.segments[2:]


def test_crumbs_go_too():
    # 0.04 is left on the left of the eraser, 0.06 on the right: half the radius lies between.
    sketch = Sketch.from_strokes([[[0.36, 0.5], [0.66, 0.5]]])
    erased = erase(sketch, [[0.5, 0.5]], 0.1)
    assert len(erased) == 1
    np.testing.assert_allclose(erased.segments[0].points, [[0.6, 0.5], [0.66, 0.5]], rtol=1e-6)


@pytest.mark.parametrize("points", [[[0.5, 0.7]], [[0.1, 0.7], [0.9, 0.7]], [[0.4, 0.5], [0.4, 0.9]]])
def test_nothing_under_the_eraser_gives_the_same_object(points):
    sketch = Sketch.from_strokes([points])
    assert erase(sketch, [[0.5, 0.5]], 0.1) is sketch


def test_an_empty_sketch_has_nothing_to_erase():
    assert erase(sketch := Sketch(), [[0.5, 0.5]], 0.1) is sketch


def test_points_drawn_twice_do_no_harm():
    sketch = Sketch.from_strokes([[[0.1, 0.5], [0.1, 0.5], [0.5, 0.5], [0.5, 0.5], [0.9, 0.5]]])
    assert len(erase(sketch, [[0.5, 0.5], [0.5, 0.5]], 0.1)) == 2


def spread(image):
    """The image with the eight neighbours of its ink: cutting a line may move the rounding of its pixels by one."""
    return cv2.dilate(image.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0


@given(drawings, paths, radii)
def test_erasing_never_adds_ink(drawing, path, radius):
    sketch = Sketch.from_strokes(drawing)
    assert not (erase(sketch, path, radius).image(128) & ~spread(sketch.image(128))).any()


@given(drawings, paths, radii)
@example([[[0.21875, 0.21875], [0.21875, 0.9902], [0.0, 1.0]]], [[0.21875, 1.0]], 0.046875)
def test_ink_outside_the_eraser_stays(drawing, path, radius):
    sketch = Sketch.from_strokes(drawing)
    missing = sketch.image(128) & ~spread(erase(sketch, path, radius).image(128))
    missing[[0, -1]] = missing[:, [0, -1]] = False  # along the border, a line that is cut may round off the picture
    gone = np.argwhere(missing)[::7, ::-1]
    # Crumbs reach half a radius out, and ink is some pixels broad.
    assert distance_to_path((gone + 0.5) / 128, path).max(initial=0) <= 1.5 * radius + 4 / 128


@given(drawings, paths, radii)
def test_fragments_are_outside_the_eraser(drawing, path, radius):
    sketch = Sketch.from_strokes(drawing)
    for segment in erase(sketch, path, radius).segments:
        if not any(segment is whole for whole in sketch.segments):
            assert distance_to_path(resample(segment.points, 20), path).min() >= radius - 1e-3


@given(drawings, paths, radii)
def test_erasing_twice_is_erasing_once(drawing, path, radius):
    erased = erase(Sketch.from_strokes(drawing), path, radius)
    assert erase(erased, path, radius) is erased


@given(drawings, paths, radii)
def test_fragments_keep_the_vertices_that_were_drawn(drawing, path, radius):
    sketch = Sketch.from_strokes(drawing)
    drawn = {tuple(point) for segment in sketch.segments for point in segment.points.tolist()}
    for segment in erase(sketch, path, radius).segments:
        assert {tuple(point) for point in segment.points[1:-1].tolist()} <= drawn


@given(drawings, paths, radii)
def test_what_is_hit_does_not_depend_on_the_frame(drawing, path, radius):
    def hit(strokes, path, radius):
        sketch = Sketch.from_strokes(strokes)
        left = erase(sketch, path, radius).segments
        return {i for i, whole in enumerate(sketch.segments) if all(whole is not piece for piece in left)}

    near, far = hit(drawing, path, radius * 0.999), hit(drawing, path, radius * 1.001)
    assert near <= hit([1 - stroke for stroke in drawing], 1 - path, radius) <= far


def test_10000_strokes_are_erased():
    rng = np.random.default_rng(0)
    steps = rng.normal(0, 0.003, (10_000, 20, 2)).cumsum(axis=1) + rng.uniform(0.1, 0.9, (10_000, 1, 2))
    sketch = Sketch(tuple(Segment("unnamed", points) for points in steps))
    erased = erase(sketch, np.linspace([0, 0], [1, 1], 50), 0.02)
    gone = sketch.image() & ~erased.image()
    assert gone.any()
    assert not erased.image()[np.arange(20, 230), np.arange(20, 230)].any()


@pytest.mark.parametrize("radius", [0, -0.1, 1.5, float("nan"), float("inf"), "0.1", None, True, 1j, [0.1]])
def test_a_radius_out_of_range_is_an_error(radius):
    with pytest.raises(ValueError, match="the radius is a number"):
        erase(Sketch(), [[0.5, 0.5]], radius)


@pytest.mark.parametrize("path", [[], [0.5, 0.5], [[np.nan, 0]], [[5, 5]]])
def test_a_path_that_is_no_stroke_is_an_error(path):
    with pytest.raises(ValueError, match="a stroke"):
        erase(Sketch(), path, 0.1)


def test_an_eraser_comes_to_one_segment_first():
    sketch = Sketch().with_segment("nose", [[0.2, 0.1], [0.2, 0.9]]).with_segment("wrinkle", [[0.8, 0.1], [0.8, 0.9]])
    assert first_touched(sketch, [[0.0, 0.5], [1.0, 0.5]], 0.05) == 0
    assert first_touched(sketch, [[1.0, 0.5], [0.0, 0.5]], 0.05) == 1
    assert first_touched(sketch, [[0.5, 0.5]], 0.05) is None
    assert first_touched(sketch, [[0.52, 0.5]], 0.4) == 1


def test_where_lines_meet_the_path_tells_which_is_meant():
    sketch = (
        Sketch()
        .with_segment("mouth_upper", [[0.4, 0.5], [0.6, 0.48]])
        .with_segment("mouth_lower", [[0.4, 0.5], [0.6, 0.52]])
    )
    for index in (0, 1):
        assert first_touched(sketch, sketch.segments[index].points, 0.05) == index
