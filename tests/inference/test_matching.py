"""Finding which drawn points lie on which line of a face."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget import FaceModel
from sketchwidget.face.drawing import outline
from sketchwidget.geometry import View
from sketchwidget.inference.matching import GROUPS, PLACES, DrawnLines, OrderedLines, shape_code
from sketchwidget.inference.shape_code import COUNTS, ShapeModel, sample, split_lines
from sketchwidget.sketch import FEATURES, SILHOUETTE, WRINKLE

ANGLE = np.linspace(0, 2 * np.pi, 81)
CIRCLE = np.stack([np.cos(ANGLE), np.sin(ANGLE)], axis=1)


def _mean_face():
    face = FaceModel.load().face()
    lines = {name: View().project(face.curve(name)) for name in (SILHOUETTE, *FEATURES)}
    return sample(lines | {SILHOUETTE: outline(lines[SILHOUETTE])}).astype(np.float64)


POINTS = _mean_face()
LINES = split_lines(POINTS)


def ellipse(*names, by=(0.0, 0.0)):
    """One stroke about some lines."""
    points = np.concatenate([LINES[name] for name in names])
    low, high = points.min(axis=0), points.max(axis=0)
    return (low + high) / 2 + CIRCLE * (high - low) / 2 + by


def match(strokes, names, settled=False):
    """The drawn point for each of the mean face's, and how much it counts."""
    return DrawnLines(strokes, names).match(POINTS, settled)


def of(name, values):
    return split_lines(values)[name]


def test_an_ellipse_is_both_contours_of_an_eye():
    eye = ellipse("left_eye_upper", "left_eye_lower")
    drawn, weight = match([eye], ["left_eye_upper"])
    middle, half = (eye.min(axis=0) + eye.max(axis=0)) / 2, np.ptp(eye, axis=0) / 2
    for name, above in (("left_eye_upper", True), ("left_eye_lower", False)):
        on = (of(name, drawn) - middle) / half
        np.testing.assert_allclose(np.linalg.norm(on, axis=1), 1, atol=0.05)
        assert (of(name, weight) > 0.8).all()
        # Canvas points count downwards.
        assert (on[3:-3, 1] < 0).all() if above else (on[3:-3, 1] > 0).all()


def test_one_line_is_both_sides_of_a_shut_mouth():
    line = np.stack([np.linspace(0.4, 0.6, 9), np.full(9, 0.7)], axis=1)
    drawn, weight = match([line], ["mouth_lower"])
    for name in ("mouth_upper", "mouth_lower"):
        np.testing.assert_allclose(of(name, drawn)[:, 1], 0.7, atol=1e-6)
        assert (of(name, weight) > 0).all()


def test_only_lines_of_a_drawn_group_are_moved():
    drawn, weight = match([ellipse("right_eye_upper", "right_eye_lower", by=(0.02, 0.01))], ["right_eye_lower"])
    for name in COUNTS:
        if GROUPS[name] == "right_eye":
            assert (of(name, weight) > 0).all() and (of(name, drawn) != LINES[name]).any()
        else:
            assert (of(name, weight) == 0).all()
            np.testing.assert_array_equal(of(name, drawn), LINES[name])


@pytest.mark.parametrize("name", [WRINKLE, "unnamed", "hat"])
def test_strokes_of_other_names_are_left_out(name):
    drawn, weight = match([ellipse("nose")], [name])
    np.testing.assert_array_equal(drawn, POINTS)
    assert not weight.any()


def test_a_drawing_without_strokes_says_nothing():
    drawn, weight = match([], [])
    np.testing.assert_array_equal(drawn, POINTS)
    assert not weight.any()


def test_every_stroke_of_a_line_counts():
    halves = np.array_split(LINES["nose"], 2)
    drawn, weight = match(halves, ["nose", "nose"])
    np.testing.assert_allclose(of("nose", drawn), LINES["nose"], atol=0.003)
    assert of("nose", weight).min() > 0.98


def test_drawn_points_count_less_the_farther_they_are_and_not_at_all_beyond_reach():
    weights = []
    for away in (0.0, 0.03, 0.06, 0.13):
        _, weight = match([LINES["nose"] + [0.0, away]], ["nose"])
        weights.append(of("nose", weight).max())
    assert weights[0] == pytest.approx(1.0) and (np.diff(weights) < 0).all()
    _, weight = match([LINES["nose"] + [0.0, 0.5]], ["nose"])
    assert not weight.any()


@given(st.floats(-0.05, 0.05), st.floats(-0.05, 0.05))
def test_what_is_drawn_whole_is_brought_to_its_place_first(x, y):
    moved = LINES["left_brow"] + [x, y]
    drawn, weight = match([moved], ["left_brow"])
    np.testing.assert_allclose(of("left_brow", drawn), moved, atol=0.003)
    assert (of("left_brow", weight) > 0.98).all()


def test_a_settled_feature_out_of_reach_does_not_count():
    far = LINES["left_brow"] - [0.0, 0.2]
    assert of("left_brow", match([far], ["left_brow"])[1]).min() > 0.98
    assert not match([far], ["left_brow"], True)[1].any()


def test_a_dot_is_where_an_eye_is_and_no_shut_eye():
    middle = LINES["left_eye_upper"][[6]] + [0.02, -0.01]
    drawn, weight = match([middle], ["left_eye_upper"])
    for name in ("left_eye_upper", "left_eye_lower"):
        np.testing.assert_allclose(np.diff(of(name, drawn), axis=0), np.diff(LINES[name], axis=0), atol=1e-9)
        assert (of(name, weight) == 1).all()
    both = np.concatenate([of("left_eye_upper", drawn), of("left_eye_lower", drawn)])
    np.testing.assert_allclose((both.min(axis=0) + both.max(axis=0)) / 2, middle[0], atol=1e-9)


def test_the_lids_of_an_eye_drawn_higher_are_not_taken_for_each_other():
    up = [0.0, -0.9 * np.ptp(LINES["left_eye_upper"][:, 1])]
    strokes = [LINES[name] + up for name in ("left_eye_upper", "left_eye_lower")]
    drawn, _ = match(strokes, ["left_eye_upper", "left_eye_lower"], True)
    for name in ("left_eye_upper", "left_eye_lower"):
        np.testing.assert_allclose(of(name, drawn), LINES[name] + up, atol=0.003)


def shape_model():
    """The first of two identity weights shifts the mouth down, the second widens the outline."""
    ways = np.zeros((2 * len(POINTS), 2, 1), dtype=np.float32)
    numbers = split_lines(np.arange(len(POINTS)))
    for name in ("mouth_upper", "mouth_lower"):
        ways[2 * numbers[name] + 1, 0] = 0.02
    ways[2 * numbers[SILHOUETTE], 1] = 0.1 * (LINES[SILHOUETTE][:, :1] - 0.5)
    return ShapeModel(
        mean=POINTS.ravel().astype(np.float32),
        core=ways,
        identity_mean=np.zeros(2, np.float32),
        identity_std=np.ones(2, np.float32),
        expression_mean=np.ones(1, np.float32),
        expression_std=np.full(1, 1e-3, np.float32),
        detail_mean=np.zeros(3 * len(POINTS), np.float32),
        detail_axes=np.eye(3 * len(POINTS), 3 * len(POINTS), dtype=np.float32),
        detail_trust=np.ones(3 * len(POINTS), np.float32),
    )


@pytest.mark.parametrize("true", [(1.5, 0.0), (-1.0, 1.0), (0.5, -1.5)])
def test_the_code_of_a_drawing_is_found_from_a_guess(true):
    model = shape_model()
    wanted = np.array([[*true, 0.0]], dtype=np.float32)
    lines = split_lines(model.decode(wanted)[0])
    strokes = [np.concatenate([lines[SILHOUETTE], lines[SILHOUETTE][:1]]), lines["mouth_upper"], lines["mouth_lower"]]
    code = shape_code(model, POINTS, DrawnLines(strokes, [SILHOUETTE, "mouth_upper", "mouth_lower"]))
    assert code.shape == (3 + 3 * len(POINTS) + 1,) and code.dtype == np.float32 and code[-1] == 1
    np.testing.assert_allclose(code[:2], true, atol=0.15)
    off, weight = np.split(code[3:-1], [POINTS.size])  # as this model has details
    drawn = [*np.flatnonzero(weight)]
    numbers = split_lines(np.arange(len(POINTS)))
    assert drawn == sorted(np.concatenate([numbers[name] for name in (SILHOUETTE, "mouth_upper", "mouth_lower")]))
    there = POINTS + 0.005 * off.reshape(-1, 2) / np.maximum(weight, 1e-9)[:, None]
    np.testing.assert_allclose(there[drawn], model.decode(wanted)[0][drawn], atol=0.006)


def test_found_details_count_by_how_much_is_true_of_them():
    model, drawn = shape_model(), DrawnLines.of_points(POINTS + 0.002, np.ones(len(POINTS), dtype=bool))
    share = np.linspace(0.0, 1.0, 3 * len(POINTS), dtype=np.float32)
    whole, part = (shape_code(one, POINTS, drawn) for one in (model, replace(model, detail_trust=share)))
    assert np.abs(whole[3:-1]).max() > 0.3
    np.testing.assert_allclose(part[3:-1], share * whole[3:-1], atol=1e-6)
    np.testing.assert_array_equal(part[:3], whole[:3])


def test_a_drawing_of_unknown_strokes_has_the_code_of_none():
    code = shape_code(shape_model(), POINTS, DrawnLines([ellipse("nose")], ["unnamed"]))
    np.testing.assert_array_equal(code[:-1], 0)
    assert code[-1] == 1


def test_of_points_that_are_seen_each_run_is_a_stroke():
    numbers = split_lines(np.arange(len(POINTS)))
    seen = np.isin(np.arange(len(POINTS)), [*numbers[SILHOUETTE], *numbers["nose"][:4], *numbers["nose"][8:]])
    drawn, weight = DrawnLines.of_points(POINTS, seen).match(POINTS)
    np.testing.assert_allclose(of(SILHOUETTE, drawn), LINES[SILHOUETTE], atol=0.005)
    apart = np.linalg.norm(of("nose", drawn) - LINES["nose"], axis=1)
    assert apart[:4].max() < 1e-3 and apart[8:].max() < 1e-3 and apart[5:7].min() > 0.01
    assert not of("left_brow", weight).any()
    closing = LINES[SILHOUETTE][[0, -1]].mean(axis=0)  # the silhouette is closed: there is ink where it begins
    points = POINTS.copy()
    points[numbers[SILHOUETTE][0]] = closing
    assert np.linalg.norm(DrawnLines.of_points(POINTS, seen).match(points)[0][0] - closing) < 0.002


@pytest.mark.parametrize("seed", range(3))
def test_points_along_lines_are_nearer_the_true_ones_than_the_nearest(seed):
    """From a guess that is broader, shifted and of another mouth, lines that are drawn in pieces run either way."""
    random = np.random.default_rng(seed)
    guess = 0.5 + (POINTS - 0.5) * (1.06, 0.97) + (0.004, -0.006)
    strokes, names = [], []
    for name, line in LINES.items():
        pieces = [line] if name == SILHOUETTE else np.array_split(line, 2)
        strokes += [piece[::-1] if random.random() < 0.5 else piece for piece in pieces]
        names += [name] * len(pieces)
    lines = DrawnLines(strokes, names)
    nearest, along = (
        np.linalg.norm(found - POINTS, axis=1)
        for found in (lines.match(guess)[0], OrderedLines(lines, guess).match(guess)[0])
    )
    assert along.mean() < 0.5 * nearest.mean()
    assert along.mean() < 0.003


def test_a_dot_marks_an_eye_whose_shape_stays():
    eye = ["left_eye_upper", "left_eye_lower"]
    dot = LINES[eye[0]].mean(axis=0) + 0.004 * CIRCLE + (0.0, 0.02)
    lines = DrawnLines([dot], eye[:1])
    for one, other in zip(lines.match(POINTS), OrderedLines(lines, POINTS).match(POINTS), strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_brow_of_two_strokes_over_each_other_is_matched_to_the_nearest_points():
    brow = LINES["left_brow"]
    lines = DrawnLines([brow, np.add(brow, (0.0, 0.004))], ["left_brow"] * 2)
    for one, other in zip(lines.match(POINTS), OrderedLines(lines, POINTS).match(POINTS), strict=True):
        np.testing.assert_array_equal(of("left_brow", one), of("left_brow", other))


@pytest.mark.parametrize(
    ("names", "more"),
    [
        (("left_eye_upper", "left_eye_lower"), lambda eye: [0.3 * (eye - eye.mean(axis=0)) + eye.mean(axis=0)]),
        (("left_brow",), lambda brow: []),
        (("nose",), lambda nose: []),
    ],
    ids=["an eye with a pupil", "a brow as a loop", "a nose as a loop"],
)
def test_loops_of_which_nobody_knows_the_points_are_matched_to_the_nearest(names, more):
    loop = ellipse(*names)
    strokes = [loop, *more(loop)]
    lines = DrawnLines(strokes, [names[0], *names[1:]][: len(strokes)])
    nearest, weight = lines.match(POINTS)
    drawn, along = OrderedLines(lines, POINTS).match(POINTS)
    for name in names:
        np.testing.assert_array_equal(of(name, drawn), of(name, nearest))
        np.testing.assert_array_equal(of(name, along), of(name, weight))
        assert of(name, along).sum() > 6


@given(
    names=st.sets(st.sampled_from(FEATURES), min_size=1),
    by=st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1)),
    size=st.floats(0.2, 0.4) | st.floats(0.6, 1.5),
    settled=st.booleans(),
)
def test_a_feature_is_moved_to_where_the_middle_of_its_strokes_is(names, by, size, settled):
    strokes = [LINES[name].mean(axis=0) + size * (LINES[name] - LINES[name].mean(axis=0)) + by for name in names]
    beside, marked = DrawnLines(strokes, list(names)).beside(POINTS, settled)
    for group, at in PLACES.items():
        ink = [stroke for stroke, name in zip(strokes, names, strict=True) if GROUPS[name] == group]
        moved = "eye" in group if settled else any(part in group for part in ("brow", "eye", "mouth", "ear"))
        shift, dot = np.zeros(2), False
        if ink:
            low, high = np.concatenate(ink).min(axis=0), np.concatenate(ink).max(axis=0)
            own_low, own_high = POINTS[at].min(axis=0), POINTS[at].max(axis=0)
            shift = moved * (low + high - own_low - own_high) / 2
            dot = ("eye" in group or "mouth" in group) and (high - low).max() < 0.5 * (own_high - own_low).max()
        np.testing.assert_allclose(beside[at], POINTS[at] + shift, atol=2e-3)  # strokes are resampled
        assert (marked[at] == dot).all()
