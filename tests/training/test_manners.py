"""Manners of drawing the lines of a face."""

import numpy as np
import pytest
from scipy.ndimage import binary_dilation

from sketchwidget.face.drawing import split_line
from sketchwidget.face.wrinkles import LIPS
from sketchwidget.geometry import View
from sketchwidget.inference.framing import Frame
from sketchwidget.inference.shape_code import COUNTS, LINES, sample, sample_indices, split_lines
from sketchwidget.sketch import SILHOUETTE, Sketch, rasterise
from sketchwidget.sketch.hand import PART_LINES, PARTS, Hand
from sketchwidget.training import manners
from sketchwidget.training.manners import Manner, draw
from sketchwidget.training.shape_model import normalised

STEADY = Hand(tremor=0.0, misplacement=0.0, shorthand=0.0, extras=0.0)


@pytest.fixture(scope="module")
def lines(pipeline):
    """A laughing person's lines."""
    table = pipeline.table
    return table.lines(View().project(table.points[0, 2].astype(np.float32)))


@pytest.fixture(scope="module")
def wrinkles(pipeline):
    folds = pipeline.table.wrinkles[0, 2]
    assert np.isfinite(folds[0]).all()
    return folds


@pytest.fixture
def unbent(monkeypatch):
    monkeypatch.setattr(manners, "deform_lines", lambda sketch, random, **amounts: sketch)


def drawn(manner, lines, wrinkles=None, front=None, parts=frozenset(PARTS), hand=STEADY, seed=0):
    return draw(manner, lines, set(parts), wrinkles, front or lines, hand, np.random.default_rng(seed))


def without(monkeypatch, *gone):
    """Let the removal of lines take all pieces of some."""

    def removed(sketch, random, share):
        return Sketch(tuple(segment for segment in sketch.segments if segment.name not in gone))

    monkeypatch.setattr(manners, "remove_lines", removed)


def near(image, points, pixels=4):
    """Whether there is ink near each point (n, 2)."""
    reached = binary_dilation(image, iterations=pixels)
    column, row = np.clip(points * 256, 0, 255).astype(int).T
    return reached[row, column]


def overlap(one, other):
    return (one & other).sum() / (one | other).sum()


def test_an_exact_drawing_shows_the_face_s_own_lines(database, lines):
    exact = drawn(Manner.EXACT, lines)
    sketch = database[database.index(0, "laugh")].face.sketch(wrinkles=False)
    frame = Frame.of_outline(sketch.lines[SILHOUETTE][0])
    assert overlap(exact.image, rasterise([frame(segment.points) for segment in sketch.segments])) > 0.98
    assert exact.seen.all()
    np.testing.assert_allclose(exact.points, sample(normalised(lines)), atol=1e-5)


def test_an_exact_drawing_is_the_same_whatever_chance_says(lines, wrinkles):
    one, other = (drawn(Manner.EXACT, lines, wrinkles, seed=seed) for seed in (1, 2))
    np.testing.assert_array_equal(one.image, other.image)
    np.testing.assert_array_equal(one.points, other.points)


@pytest.mark.parametrize("manner", list(Manner))
def test_place_and_size_of_a_face_do_not_matter(lines, wrinkles, manner, monkeypatch, unbent):
    without(monkeypatch)
    moved = {name: 0.8 * line + [0.1, 0.05] for name, line in lines.items()}
    one, other = drawn(manner, lines, wrinkles), drawn(manner, moved, wrinkles, front=lines)
    assert overlap(one.image, other.image) > 0.9
    np.testing.assert_array_equal(one.seen, other.seen)
    np.testing.assert_allclose(one.points, other.points, atol=1e-3)


def test_wrinkles_and_lips_are_added_to_what_is_drawn_without(lines, wrinkles):
    plain, wrinkled = drawn(Manner.EXACT, lines), drawn(Manner.EXACT, lines, wrinkles)
    assert (plain.image <= wrinkled.image).all() and wrinkled.image.sum() > plain.image.sum() + 100
    np.testing.assert_array_equal(plain.points, wrinkled.points)
    framed = normalised(lines)
    assert all(near(wrinkled.image, framed[name], pixels=2).all() for name in LIPS)
    assert not all(near(plain.image, framed[name], pixels=2).all() for name in LIPS)


def test_wrinkles_stay_where_they_are_on_the_lines_that_they_belong_to(lines, wrinkles):
    frame = Frame.of_outline(manners.outline(lines[SILHOUETTE]))
    image = drawn(Manner.EXACT, lines, wrinkles).image
    folds = wrinkles[np.isfinite(wrinkles[:, 0, 0])].astype(np.float64)
    assert near(image, frame(folds.reshape(-1, 2)), pixels=2).all()
    carried = manners._carried(wrinkles, lines, lines)
    np.testing.assert_array_equal(np.stack(carried), folds)


def test_wrinkles_are_carried_along_with_the_lines(lines, wrinkles):
    folds, by = np.stack(manners._carried(wrinkles, lines, lines)), np.array([0.05, -0.03])
    moved = {name: line + by for name, line in lines.items()}
    np.testing.assert_allclose(manners._carried(wrinkles, lines, moved), folds + by, atol=1e-3)
    smaller = {name: 0.6 * line + [0.1, 0.2] for name, line in lines.items()}
    np.testing.assert_allclose(manners._carried(wrinkles, lines, smaller), 0.6 * folds + [0.1, 0.2], atol=1e-3)


def test_a_face_may_have_no_wrinkles(lines, wrinkles):
    for none in (wrinkles[:0], np.full_like(wrinkles, np.nan)):
        assert manners._carried(none, lines, lines) == []
        assert np.isfinite(drawn(Manner.EXACT, lines, none).points).all()


@pytest.mark.parametrize("gone", [("nose",), ("left_eye_upper", "mouth_lower"), LINES[1:]])
def test_removed_lines_are_not_seen(lines, monkeypatch, unbent, gone):
    without(monkeypatch, *gone)
    rest = drawn(Manner.AUGMENTED, lines)
    exact = drawn(Manner.EXACT, lines)
    for name, seen in split_lines(rest.seen).items():
        assert not seen.any() if name in gone else seen.all()
    np.testing.assert_array_equal(rest.points[rest.seen], exact.points[rest.seen])
    assert not rest.points[~rest.seen].any()
    assert (rest.image <= exact.image).all() and rest.image.sum() < exact.image.sum()


def test_of_a_line_of_which_a_piece_is_removed_the_others_are_seen(lines, monkeypatch, unbent):
    count = len(split_line("nose", lines["nose"])[0])

    def removed(sketch, random, share):
        first = next(segment for segment in sketch.segments if segment.name == "nose")
        return Sketch(tuple(segment for segment in sketch.segments if segment is not first))

    monkeypatch.setattr(manners, "remove_lines", removed)
    seen = split_lines(drawn(Manner.AUGMENTED, lines).seen)["nose"]
    np.testing.assert_array_equal(seen, sample_indices(len(lines["nose"])) >= count)
    assert 0 < seen.sum() < 12


def test_without_its_outline_a_drawing_is_not_framed(lines, monkeypatch, unbent):
    without(monkeypatch, SILHOUETTE)
    whole = {name: 0.9 * line + [0.0, 0.1] for name, line in lines.items()}
    rest = drawn(Manner.AUGMENTED, whole)
    points = split_lines(sample(whole | {SILHOUETTE: manners.outline(whole[SILHOUETTE])}))
    for name, found in split_lines(rest.points).items():
        if name != SILHOUETTE:
            np.testing.assert_allclose(found, points[name], atol=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_in_augmented_drawings_ink_lies_where_points_are_seen(lines, wrinkles, seed):
    augmented = drawn(Manner.AUGMENTED, lines, wrinkles, seed=seed)
    assert augmented.seen.any() and near(augmented.image, augmented.points[augmented.seen], pixels=3).all()


def test_augmented_drawings_lose_lines_and_are_bent(lines):
    exact = drawn(Manner.EXACT, lines)
    augmented = [drawn(Manner.AUGMENTED, lines, seed=seed) for seed in range(40)]
    lost = [1 - one.seen.mean() for one in augmented]
    assert max(lost) < 0.6 and 0.02 < np.mean(lost) < 0.3
    whole = [one for one in augmented if split_lines(one.seen)[SILHOUETTE].all()]
    off = [np.linalg.norm(one.points - exact.points, axis=1)[one.seen].mean() for one in whole]
    assert len(whole) > 30 and 0.001 < np.mean(off) < 0.02


@pytest.mark.parametrize("parts", [{"mouth"}, {"eyes", "brows"}, {"nose", "ears"}])
def test_freehand_drawings_have_only_the_parts_asked_for(lines, wrinkles, parts):
    one = drawn(Manner.FREEHAND, lines, wrinkles, parts=parts)
    asked = {name for part in parts for name in PART_LINES[part]}
    for name, seen in split_lines(one.seen).items():
        assert name in asked or not seen.any()
    ink = np.argwhere(one.image)[:, ::-1] / 256
    points = np.concatenate([lines[name] for name in asked])
    assert len(ink) and (ink > points.min(axis=0) - 0.03).all() and (ink < points.max(axis=0) + 0.03).all()


def test_a_freehand_drawing_of_no_parts_is_empty(lines, wrinkles):
    empty = drawn(Manner.FREEHAND, lines, wrinkles, parts=())
    assert not empty.image.any() and not empty.seen.any()


def test_a_freehand_outline_gives_the_frame(lines):
    small = {name: 0.5 * line + [0.05, 0.3] for name, line in lines.items()}
    for parts in ({"outline"}, set(PARTS)):
        ink = np.argwhere(drawn(Manner.FREEHAND, small, parts=parts).image)[:, ::-1] / 256
        np.testing.assert_allclose((ink.min(axis=0) + ink.max(axis=0)) / 2, 0.5, atol=0.04)
        assert np.ptp(ink[:, 1]) > 0.6


def test_a_steady_hand_draws_the_lines_where_they_are(lines):
    exact = sample(normalised(lines))
    found = [drawn(Manner.FREEHAND, lines, seed=seed) for seed in range(20)]
    closed = [one for one in found if np.abs(split_lines(one.points)[SILHOUETTE] - exact[:60]).max() < 0.03]
    assert len(closed) > 10
    assert max(np.abs(one.points - exact).max() for one in closed) < 0.04


def test_not_every_freehand_line_is_recognised(lines):
    seen = np.array(
        [[of.all() for of in split_lines(drawn(Manner.FREEHAND, lines, seed=seed).seen).values()] for seed in range(60)]
    )
    assert 0.8 < seen.mean() < 0.97 and seen.any(axis=0).all() and not seen.all(axis=0).all()


def test_freehand_wrinkles_are_drawn_on_whole_faces_only(lines, wrinkles):
    def more(parts):
        plain, wrinkled = (drawn(Manner.FREEHAND, lines, folds, parts=parts).image.sum() for folds in (None, wrinkles))
        return wrinkled - plain

    assert more(PARTS) > 50
    assert more({"outline", "eyes", "mouth"}) == 0


@pytest.mark.parametrize("manner", list(Manner))
def test_a_drawing_is_what_networks_see(lines, wrinkles, manner):
    one = drawn(manner, lines, wrinkles, hand=Hand(), seed=4)
    count = sum(COUNTS.values())
    assert one.image.shape == (256, 256) and one.image.dtype == bool
    assert one.points.shape == (count, 2) and one.seen.shape == (count,) and one.seen.dtype == bool
    assert np.isfinite(one.points).all()
    again = drawn(manner, lines, wrinkles, hand=Hand(), seed=4)
    np.testing.assert_array_equal(again.image, one.image)
    np.testing.assert_array_equal(again.points, one.points)
