"""What covers a point, and which points nothing hides."""

import numpy as np
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from sketchwidget.geometry.view import rotation_about_y
from sketchwidget.geometry.visibility import covering, visible

TRIANGLE = np.array([[0.0, 0, 2], [4, 0, 2], [0, 4, 2]])
FACING, AWAY = np.array([[0, 1, 2]]), np.array([[0, 2, 1]])

grid = st.integers(-4, 4).map(float)
points = hnp.arrays(np.float64, st.tuples(st.integers(0, 8), st.just(3)), elements=grid)
vertices = hnp.arrays(np.float64, st.tuples(st.integers(3, 8), st.just(3)), elements=grid)


def test_a_triangle_covers_what_lies_within_its_outline():
    point, above = covering(np.array([[1.0, 1, 0], [3, 3, 0], [-1, 1, 0], [1, 2, 5]]), TRIANGLE, FACING)
    found = dict(zip(point.tolist(), above.tolist(), strict=True))
    assert found == {0: 2.0, 3: -3.0}


def test_a_slanted_triangle_lies_above_a_point_by_its_plane():
    slanted = TRIANGLE + np.array([[0, 0, 0], [0, 0, 4], [0, 0, 8]])  # z = 2 + x + 2 y
    point, above = covering(np.array([[1.0, 2, 3]]), slanted, FACING)
    np.testing.assert_array_equal(point, [0])
    np.testing.assert_allclose(above, [2 + 1 + 4 - 3])


def test_a_triangle_that_faces_away_or_is_seen_edge_on_covers_nothing():
    for vertices, faces in ((TRIANGLE, AWAY), (TRIANGLE[:, [0, 2, 1]], FACING), (np.zeros((3, 3)), FACING)):
        point, above = covering(np.array([[1.0, 1, 0], [0, 0, 0], [1, 2, 0]]), vertices, faces)
        assert point.shape == above.shape == (0,)


def test_no_points_have_nothing_over_them():
    point, above = covering(np.empty((0, 3)), TRIANGLE, FACING)
    assert point.shape == above.shape == (0,) and np.issubdtype(point.dtype, np.integer)


def test_a_point_is_named_once_for_each_triangle_over_it():
    two = np.concatenate([TRIANGLE, TRIANGLE + np.array([0, 0, 3])])
    point, above = covering(np.array([[1.0, 1, 0]]), two, np.concatenate([FACING, FACING + 3]))
    assert point.tolist() == [0, 0] and sorted(above) == [2.0, 5.0]


@given(points, vertices, st.data())
def test_covering_is_what_one_triangle_after_the_other_covers(points, vertices, data):
    corner = st.integers(0, len(vertices) - 1)
    faces = np.array(data.draw(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=8)))
    within, on_the_edge = {}, {}
    for number, point in enumerate(points):
        for a, b, c in vertices[faces]:
            sides = [np.linalg.det([(end - start)[:2], (point - start)[:2]]) for start, end in ((a, b), (b, c), (c, a))]
            sides = np.rint(sides)  # all coordinates are whole numbers
            if sides.sum() > 0 and sides.min() >= 0:
                above = np.dot(np.roll(sides, -1), [a[2], b[2], c[2]]) / sides.sum() - point[2]
                (within if sides.min() > 0 else on_the_edge).setdefault(number, []).append(above)
    point, above = covering(points, vertices, faces)
    for number in range(len(points)):
        found = sorted(above[point == number])
        sure, possible = sorted(within.get(number, [])), sorted(within.get(number, []) + on_the_edge.get(number, []))
        assert len(sure) <= len(found) <= len(possible)
        assert all(np.abs(np.array(possible) - one).min() < 1e-9 for one in found)
        assert all(np.abs(np.array(found) - one).min() < 1e-9 for one in sure)


def test_of_a_ball_the_near_half_is_visible():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=50)
    turn = rotation_about_y(-40)
    depth = ball.vertices @ turn[2]
    clear = visible(ball.vertices, ball.vertices, ball.faces, turn)
    assert clear[depth > 8].all() and not clear[depth < -8].any()


def test_what_stands_before_a_point_hides_it():
    balls = [trimesh.creation.icosphere(subdivisions=3, radius=radius) for radius in (50, 20)]
    vertices = np.concatenate([balls[0].vertices, balls[1].vertices + np.array([0, 0, 90])])
    faces = np.concatenate([balls[0].faces, balls[1].faces + len(balls[0].vertices)])
    points = np.array([[0.0, 0, 50], [15, 0, 47.7], [25, 0, 43.3], [0, 0, 110]])
    assert visible(points, vertices, faces, np.eye(3)).tolist() == [False, False, True, True]
    assert visible(np.empty((0, 3)), vertices, faces, np.eye(3)).shape == (0,)


def test_what_lies_behind_a_corner_or_an_edge_is_hidden():
    """Seen from the side, the vertices of a symmetric mesh lie exactly behind one another."""
    ball = trimesh.creation.icosphere(3, 20.0)
    side = rotation_about_y(90)
    for vertices in (ball.vertices, ball.vertices.astype(np.float32)):
        clear = visible(vertices, vertices, ball.faces, side)
        assert not clear[vertices @ side[2] < -3].any()
