"""Triangles that cut each other."""

import igl
import numpy as np
import pytest
import trimesh

from sketchwidget.geometry.intersection import intersecting, self_intersecting

FLAT = [[0, 0, 0], [2, 0, 0], [0, 2, 0]]
ONE, OTHER = np.array([[0, 1, 2]]), np.array([[3, 4, 5]])


def pairs(*triangle):
    return intersecting(np.array([*FLAT, *triangle], dtype=float), ONE, OTHER).tolist()


@pytest.mark.parametrize(
    ("triangle", "cuts"),
    [
        ([[0.5, 0.5, -1], [0.5, 0.5, 1], [0.6, 0.5, 1]], True),  # pierces it
        ([[-1, 0.5, -1], [3, 0.5, -1], [0.5, 0.5, 3]], True),  # is cut by two of its edges
        ([[0.5, 0.5, 1], [0.7, 0.5, 2], [0.6, 0.9, 1]], False),  # above
        ([[1.5, 1.5, -1], [1.5, 1.5, 1], [1.6, 1.5, 1]], False),  # beside, though within its box
    ],
)
def test_cases_by_hand(triangle, cuts):
    assert pairs(*triangle) == ([[0, 0]] if cuts else [])


def test_neighbours_share_a_vertex_and_do_not_count():
    points = np.array([*FLAT, [0, 0, 1], [1, 1, -1]], dtype=float)
    assert intersecting(points, ONE, np.array([[0, 3, 4]])).size == 0


def test_pairs_are_numbered_within_their_patches():
    cut = np.array([[0.5, 0.5, -1], [0.5, 0.5, 1], [0.6, 0.5, 1]])
    points = np.concatenate([FLAT, cut + np.array([9, 0, 0]), cut])
    assert intersecting(points, ONE, np.array([[3, 4, 5], [6, 7, 8]])).tolist() == [[0, 1]]


def test_the_library_s_test_of_two_triangles_agrees():
    random = np.random.default_rng(0)
    found = []
    for points in random.normal(size=(3000, 6, 3)):
        expected = igl.tri_tri_intersection_test_3d(*(point[None] for point in points))[0]
        found.append(len(intersecting(points, ONE, OTHER)) == 1)
        assert found[-1] == expected
    assert 0.1 < np.mean(found) < 0.9


def test_a_mesh_that_cuts_itself():
    """Against all pairs at once; two balls in each other, then apart, in one mesh."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    faces = np.concatenate([ball.faces, ball.faces + len(ball.vertices)])
    vertices = np.concatenate([ball.vertices, ball.vertices + np.array([0.7, 0.2, 0.1])])
    found = self_intersecting(vertices, faces)
    pairs = intersecting(vertices, ball.faces, faces[len(ball.faces) :])
    assert {tuple(pair) for pair in found.tolist()} == {(a, b + len(ball.faces)) for a, b in pairs.tolist()}
    assert len(found) > 20
    assert not len(self_intersecting(ball.vertices, ball.faces))
    vertices[len(ball.vertices) :] += [3, 0, 0]
    assert not len(self_intersecting(vertices, faces))
