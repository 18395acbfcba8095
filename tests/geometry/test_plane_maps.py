"""Maps of triangles in the plane, as two complex numbers each."""

import numpy as np
import pytest

from sketchwidget.geometry.plane_maps import PlaneMaps, in_plane, least_stretch

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0.05, 0, 1]], dtype=float)
TRIANGLES = np.array([[0, 1, 2], [1, 3, 2], [0, 2, 4]])


@pytest.mark.parametrize(
    ("matrix", "along", "across", "least"),
    [
        ([[1, 0], [0, 1]], 1, 0, 1),
        ([[0, -2], [2, 0]], 2j, 0, 2),
        ([[3, 0], [0, 1]], 2, 1, 1),
        ([[1, 0], [0, -1]], 0, 1, -1),
    ],
)
def test_maps_of_linear_maps(matrix, along, across, least):
    maps = PlaneMaps(CORNERS, TRIANGLES)
    found = maps(in_plane(CORNERS[:, :2] @ np.array(matrix).T))
    np.testing.assert_allclose(found, np.tile([along, across], (3, 1)), atol=1e-12)
    np.testing.assert_allclose(least_stretch(found), least)


def test_areas_are_seen_from_the_front():
    np.testing.assert_allclose(PlaneMaps(CORNERS, TRIANGLES).areas, [0.5, 0.5, 0.025])


def test_what_is_seen_edge_on_does_not_face():
    np.testing.assert_array_equal(PlaneMaps(CORNERS, TRIANGLES).facing(np.arange(3)), [0, 1])


def test_a_triangle_of_no_area_spoils_nothing():
    corners = CORNERS * [1, 1, 0]
    corners[4] = [0, 0.5, 1]
    maps = PlaneMaps(corners, TRIANGLES)
    np.testing.assert_allclose(maps.turns(maps(1j * in_plane(corners))), 1j)


def test_slopes_give_the_change_of_the_maps():
    maps, displaced = PlaneMaps(CORNERS, TRIANGLES), np.random.default_rng(0).normal(size=(5, 2))
    before, moves = in_plane(CORNERS), in_plane(displaced)
    slopes = maps.slopes(np.array([1, 2]))
    change = np.stack([slopes @ moves, slopes @ moves.conj()], axis=1)
    np.testing.assert_allclose(change, (maps(before + moves) - maps(before))[1:])


def test_a_folded_triangle_turns_with_those_beside_it():
    maps = PlaneMaps(CORNERS, TRIANGLES[:2])
    turned = 1j * in_plane(CORNERS)
    turned[3] = 1j * 0.4  # pushed over the edge from 1 to 2
    found = maps(turned)
    assert least_stretch(found)[1] < 0
    np.testing.assert_allclose(np.angle(maps.turns(found)), np.pi / 2, atol=0.3)
