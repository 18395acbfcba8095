"""Erasing parts of lines and drawing them anew, in 2D."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sketchwidget.sketch import Piece
from sketchwidget.sketch.crossing import cross, without_loops
from sketchwidget.sketch.gap import GapError, carried_on, closed, feature_gap, fill, goes_on, outline_gap
from sketchwidget.sketch.partner import follow, partner_of
from sketchwidget.sketch.piece import handle_points, slid

TURN = np.linspace(0, 2 * np.pi, 81)
CIRCLE = np.stack([0.5 + 0.4 * np.sin(TURN), 0.5 - 0.4 * np.cos(TURN)], axis=1).astype(np.float32)
CIRCLE[-1] = CIRCLE[0]
OUTLINE = Piece("silhouette", CIRCLE, np.linspace(0, 20, 81))


def line(name, x, y):
    """Three pieces of four points each, from left to right at one height."""
    points = np.stack([x + np.arange(12) * 0.02, np.full(12, y)], axis=1)
    return [Piece(name, points[n : n + 4], np.arange(n, n + 4)) for n in (0, 4, 8)]


def test_handle_points_of_pieces():
    pieces = line("nose", 0.3, 0.5)
    found = handle_points(pieces[::2], 12)
    np.testing.assert_allclose(found[[0, 3, 8, 11]], [[0.3, 0.5], [0.36, 0.5], [0.46, 0.5], [0.52, 0.5]], atol=1e-6)
    assert np.isnan(found[4:8]).all()


def test_handle_points_of_a_closed_line_wherever_it_begins():
    whole = handle_points([OUTLINE], 21)
    np.testing.assert_allclose(whole, CIRCLE[::4], atol=1e-6)
    kept, gap = outline_gap(OUTLINE, OUTLINE, [[0.5, 0.9]], 0.05)
    again = closed(kept, gap.erased)
    np.testing.assert_allclose(handle_points([again], 21), whole, atol=1e-5)
    assert again.is_closed and again.high - again.low == pytest.approx(20)


def test_handle_points_slide_along_the_outline_to_where_a_head_has_them():
    turn = np.linspace(0, 2 * np.pi, 21) + 0.1
    head = np.stack([0.5 + 0.41 * np.sin(turn), 0.5 - 0.41 * np.cos(turn)], axis=1)
    free = np.zeros(21, dtype=bool)
    np.testing.assert_allclose(slid(OUTLINE, head, free), 0.5 + (head - 0.5) * 0.4 / 0.41, atol=2e-3)
    held = np.arange(21) == 3
    assert slid(OUTLINE, head, held)[3] == pytest.approx(CIRCLE[12], abs=1e-6)
    far = head + 1.0
    np.testing.assert_allclose(slid(OUTLINE, far, free), CIRCLE[::4], atol=1e-3)


def test_an_inner_piece_has_two_open_ends_and_an_outer_one_has_one():
    pieces = line("nose", 0.3, 0.5)
    kept, gap = feature_gap(pieces, 4, 7)
    assert kept == [pieces[0], pieces[2]]
    np.testing.assert_allclose(gap.ends, [[0.36, 0.5], [0.46, 0.5]], atol=1e-6)
    np.testing.assert_allclose(feature_gap(pieces, 0, 3)[1].ends, [[0.38, 0.5]], atol=1e-6)


@pytest.mark.parametrize("backwards", [False, True])
def test_a_stroke_is_snapped_to_the_open_ends_whichever_way_it_ran(backwards):
    _, gap = feature_gap(line("nose", 0.3, 0.5), 4, 7)
    x = np.linspace(0.365, 0.452, 30)
    stroke = np.stack([x, 0.49 - 0.02 * np.sin((x - 0.36) / 0.1 * np.pi)], axis=1)
    piece = fill(gap, stroke[::-1] if backwards else stroke)
    assert (piece.low, piece.high) == (4, 7)
    assert (np.diff(piece.points[:, 0]) > 0).all()
    assert 0.36 < piece.points[0, 0] < 0.39 and 0.43 < piece.points[-1, 0] < 0.46
    assert piece.points[:, 1].min() == pytest.approx(0.47, abs=2e-3)


@pytest.mark.parametrize("backwards", [False, True])
def test_a_stroke_that_is_still_drawn_bends_back_to_the_erased_line(backwards):
    _, gap = feature_gap(line("nose", 0.3, 0.5), 0, 11)
    x = np.linspace(0.3, 0.36, 7) if not backwards else np.linspace(0.52, 0.46, 7)
    stroke = np.stack([x, np.full(7, 0.48)], axis=1)
    whole = carried_on(gap, stroke)
    np.testing.assert_array_equal(whole[:7], stroke)
    there, before = whole[-1], gap.erased.points[0 if backwards else -1]
    np.testing.assert_allclose(there, before, atol=1e-6)
    assert (np.diff(whole[:, 1]) >= 0).all() and (np.diff(whole[:, 0]) * (-1 if backwards else 1) >= -1e-9).all()


def test_a_stroke_that_came_to_the_end_is_not_carried_on():
    _, gap = feature_gap(line("nose", 0.3, 0.5), 0, 11)
    stroke = np.stack([np.linspace(0.3, 0.52, 20), np.full(20, 0.47)], axis=1)
    np.testing.assert_array_equal(carried_on(gap, stroke), stroke)


def test_points_correspond_by_arc_length():
    """Along a stroke that is parallel to the line, a handle point goes straight across."""
    pieces = line("nose", 0.3, 0.5)
    _, gap = feature_gap(pieces, 0, 11)
    piece = fill(gap, np.stack([np.linspace(0.3, 0.52, 50), np.full(50, 0.45)], axis=1))
    np.testing.assert_allclose(
        handle_points([piece], 12), np.stack([0.3 + np.arange(12) * 0.02, np.full(12, 0.45)], 1), atol=1e-4
    )


def test_the_join_is_smooth():
    kept, gap = outline_gap(OUTLINE, OUTLINE, [[0.35, 0.87], [0.65, 0.87]], 0.02)
    a, b = gap.ends
    t = np.linspace(0, np.pi, 50)
    stroke = np.stack([a[0] + (b[0] - a[0]) * (1 - np.cos(t)) / 2, a[1] + 0.1 * np.sin(t)], axis=1)
    outline = closed(kept, fill(gap, stroke)).points.astype(np.float64)
    steps = np.diff(outline[np.append(True, np.linalg.norm(np.diff(outline, axis=0), axis=1) > 1e-4)], axis=0)
    way = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    assert np.abs(np.diff(way)).max() < 0.6
    assert outline[:, 1].max() == pytest.approx(a[1] + 0.1, abs=3e-3)


def test_erased_parts_of_the_outline_are_joined_the_shorter_way():
    kept, gap = outline_gap(OUTLINE, OUTLINE, [[0.5, 0.9]], 0.03)
    kept, gap = outline_gap(OUTLINE, kept, [[0.9, 0.5]], 0.03)
    low, high = gap.erased.points.min(axis=0), gap.erased.points.max(axis=0)
    assert low[0] < 0.5 < 0.89 < high[0] and low[1] < 0.5 < 0.89 < high[1]
    assert kept.points[:, 0].min() == pytest.approx(0.1, abs=1e-3)
    np.testing.assert_allclose(
        sorted([kept.points[0].tolist(), kept.points[-1].tolist()]), sorted(gap.ends.tolist()), atol=1e-6
    )


def test_an_eraser_that_misses_the_outline_takes_nothing():
    assert outline_gap(OUTLINE, OUTLINE, [[0.5, 0.5]], 0.05) is None


def test_something_of_the_outline_must_stay():
    with pytest.raises(GapError, match="would stay"):
        outline_gap(OUTLINE, OUTLINE, CIRCLE, 0.05)


@pytest.mark.parametrize(
    ("stroke", "complaint"),
    [
        ([[0.4, 0.5]], "a dot"),
        (0.005 * CIRCLE + [0.4, 0.5], "a dot|a loop"),
        (0.1 * CIRCLE + [0.36, 0.45], "a loop"),
        (np.tile(0.1 * CIRCLE, (10, 1)) + np.array([0.36, 0.45]), "far longer"),
        ([[0.9, 0.95], [0.95, 0.9]], "nowhere near"),
    ],
)
def test_what_closes_no_gap_is_refused(stroke, complaint):
    _, gap = feature_gap(line("nose", 0.3, 0.5), 4, 7)
    with pytest.raises(GapError, match=complaint):
        fill(gap, np.asarray(stroke, dtype=np.float32))


def test_a_stroke_that_crosses_itself_loses_its_loop():
    t = np.linspace(0, 2 * np.pi, 60)
    loop = np.stack([0.41 + 0.015 * np.sin(t), 0.485 + 0.015 * np.cos(t)], axis=1)
    stroke = np.concatenate([[[0.36, 0.5], [0.40, 0.5]], loop, [[0.42, 0.5], [0.46, 0.5]]])
    _, gap = feature_gap(line("nose", 0.3, 0.5), 4, 7)
    piece = fill(gap, stroke)
    assert not cross(piece.points[:-2], piece.points[2:]) or len(without_loops(piece.points)) == len(piece.points)
    assert piece.points[:, 1].min() > 0.48


def test_an_outline_may_not_cross_itself():
    kept, gap = outline_gap(OUTLINE, OUTLINE, [[0.35, 0.87], [0.65, 0.87]], 0.02)
    a, b = gap.ends
    with pytest.raises(GapError, match="cross"):
        closed(kept, fill(gap, np.array([a, [0.97, 0.75], b])))


def test_loops_worked_by_hand():
    line = np.array([[0.0, 0], [2, 0], [2, 2], [1, 2], [1, -1]])
    np.testing.assert_allclose(without_loops(line), [[0, 0], [1, 0], [1, -1]])
    assert cross(np.array([[0, 0], [1, 1]]), np.array([[0, 1], [1, 0]]))
    assert not cross(np.array([[0, 0], [1, 1]]), np.array([[2, 1], [3, 0]]))


def test_partners():
    assert partner_of("mouth_upper") == "mouth_lower" and partner_of("left_eye_lower") == "left_eye_upper"
    assert partner_of("nose") is None and partner_of("silhouette") is None


def test_a_partner_follows_by_the_similarity_of_the_corners():
    upper, lower = line("mouth_upper", 0.4, 0.6), line("mouth_lower", 0.4, 0.6)
    lower = [
        piece.moved(piece.points + [0, 0.03] * (np.sin((piece.points[:, :1] - 0.4) / 0.22 * np.pi))) for piece in lower
    ]
    wide = [piece.moved((piece.points - [0.5, 0.6]) * 1.5 + [0.5, 0.55]) for piece in upper]
    moved = follow(lower, upper, wide, 2)
    assert (moved[0].points[0] == wide[0].points[0]).all() and (moved[-1].points[-1] == wide[-1].points[-1]).all()
    deepest = max(piece.points[:, 1].max() for piece in moved)
    assert deepest == pytest.approx(0.55 + 1.5 * (max(piece.points[:, 1].max() for piece in lower) - 0.6), abs=1e-3)


def test_lips_close_and_do_not_pass_through_each_other():
    upper, lower = line("mouth_upper", 0.4, 0.6), line("mouth_lower", 0.4, 0.6)
    sagging = [
        piece.moved(piece.points + [0, 0.04] * np.sin((piece.points[:, :1] - 0.4) / 0.22 * np.pi)) for piece in upper
    ]
    moved = follow(lower, upper, sagging, 2)
    for above, below in zip(sagging, moved, strict=True):
        assert (below.points[:, 1] >= above.points[:, 1] - 5e-4).all()  # 0.1 mm


coordinates = st.floats(0.2, 0.8)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(coordinates, coordinates), min_size=2, max_size=12))
def test_any_stroke_closes_the_gap_or_is_refused(points):
    kept, gap = outline_gap(OUTLINE, OUTLINE, [[0.35, 0.87], [0.65, 0.87]], 0.02)
    try:
        outline = closed(kept, fill(gap, np.array(points)))
    except GapError:
        return
    assert outline.is_closed and np.isfinite(outline.points).all()
    assert np.isfinite(handle_points([outline], 21)).all()


@pytest.mark.parametrize("back", [False, True])
def test_a_stroke_that_goes_on_along_the_line_is_told_from_one_that_overshoots(back):
    pieces = line("nose", 0.3, 0.5)
    _, inner = feature_gap(pieces, 4, 7)  # from 0.36 to 0.46
    _, outer = feature_gap(pieces, 0, 3)  # up to 0.38

    def stroke(start, end, rise=0.0):
        points = np.array([[start, 0.5 - rise], [end, 0.5 - rise]])
        return points[::-1] if back else points

    assert goes_on(inner, stroke(0.3, 0.52)) and goes_on(inner, stroke(0.3, 0.52, 0.02))
    assert goes_on(outer, stroke(0.3, 0.52)) and goes_on(outer, stroke(0.29, 0.46, 0.02))
    for start, end in ((0.36, 0.46), (0.335, 0.485), (0.38, 0.44), (0.4, 0.5)):
        assert not goes_on(inner, stroke(start, end)) and not goes_on(inner, stroke(start, end, 0.02))
    assert not goes_on(outer, stroke(0.1, 0.4))  # past the end of the line itself
    assert not goes_on(outer, np.array([[0.3, 0.5], [0.37, 0.5], [0.38, 0.3]]))  # another way than the line
