"""A part of a mesh deformed by handles."""

import igl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sketchwidget.geometry.region_deformation import RegionDeformation, within_reach


def grid(size):
    """Vertices (size^2, 3) of a flat square with unit cells, row after row, and its triangles."""
    row, column = np.mgrid[:size, :size]
    vertices = np.stack([column.ravel(), row.ravel(), np.zeros(size**2)], axis=1).astype(float)
    corner = (row[:-1, :-1] * size + column[:-1, :-1]).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + size], axis=1),
            np.stack([corner + 1, corner + size + 1, corner + size], axis=1),
        ]
    )
    return vertices, faces


def inner(size, margin):
    """Vertices of the grid that are not within `margin` of its edge."""
    row, column = np.mgrid[:size, :size]
    return (np.minimum.reduce([row, column, size - 1 - row, size - 1 - column]) >= margin).ravel()


SIZE = 21
VERTICES, FACES = grid(SIZE)
REGION, MIDDLE = inner(SIZE, 4), SIZE**2 // 2


def test_handles_go_where_they_are_wanted_and_nothing_outside_moves():
    handles = np.array([MIDDLE, MIDDLE + 3])
    wanted = np.array([[0.0, 1, 2], [3, 4, 5]])
    moved = RegionDeformation(VERTICES, FACES, REGION, handles).displacement(wanted)
    np.testing.assert_allclose(moved[handles], wanted)
    assert (moved[~REGION] == 0).all() and (np.abs(moved[REGION]).max(axis=1) > 0).all()


def test_a_surface_bent_along_its_rim_alone_follows_it():
    """What is linear has no Laplacian: the least energy is 0."""
    everything = np.ones(SIZE**2, dtype=bool)
    rim = np.flatnonzero(~inner(SIZE, 2))
    wanted = VERTICES @ np.array([[0.1, 0, 0.3], [0, -0.2, 0.5], [0, 0, 0]]) + [1, 2, 3]
    moved = RegionDeformation(VERTICES, FACES, everything, rim).displacement(wanted[rim])
    np.testing.assert_allclose(moved, wanted, atol=1e-8)


def test_the_energy_is_the_least_there_is():
    """Dense least squares on a bumpy surface, as an independent solution."""
    vertices = VERTICES + np.random.default_rng(0).normal(0, 0.1, VERTICES.shape)
    laplacian = igl.cotmatrix(vertices, FACES).toarray()
    area = igl.massmatrix(vertices, FACES, igl.MASSMATRIX_TYPE_BARYCENTRIC).diagonal()
    scaled = laplacian / np.sqrt(area)[:, None]
    free = REGION.copy()
    free[MIDDLE] = False
    least, *_ = np.linalg.lstsq(scaled[:, free], -scaled[:, MIDDLE], rcond=None)
    weights = RegionDeformation(vertices, FACES, REGION, np.array([MIDDLE])).displacement(np.ones((1, 3)))[:, 0]
    np.testing.assert_allclose(weights[free], least, atol=1e-6)


def test_the_displacement_leaves_the_border_at_slope_0():
    moved = RegionDeformation(VERTICES, FACES, REGION, np.array([MIDDLE])).displacement(np.ones((1, 3)))
    weights = moved[:, 0].reshape(SIZE, SIZE)
    first, second = weights[SIZE // 2, 4], weights[SIZE // 2, 5]  # one and two cells in
    assert 0 < first < 0.4 * second  # a crease would give a half, a parabola gives a quarter


@settings(max_examples=20)
@given(st.integers(0, 10_000))
def test_it_turns_and_grows_with_the_mesh(seed):
    random = np.random.default_rng(seed)
    turn, scale = Rotation.random(rng=random).as_matrix(), random.uniform(0.1, 10)
    handles, wanted = np.array([MIDDLE - 2, MIDDLE + 2]), random.normal(size=(2, 3))
    here = RegionDeformation(VERTICES, FACES, REGION, handles).displacement(wanted)
    there = RegionDeformation(scale * VERTICES @ turn.T, FACES, REGION, handles).displacement(scale * wanted @ turn.T)
    np.testing.assert_allclose(there, scale * here @ turn.T, atol=1e-8 * scale)


def test_handles_fade_towards_the_border():
    row = SIZE * (SIZE // 2)
    handles = row + np.array([4, 5, 6, 7, 10])  # 1, 2, 3, 4 and 7 cells from what lies outside
    deformation = RegionDeformation(VERTICES, FACES, REGION, handles)
    at = np.array([1, 2, 3, 4]) / 4
    np.testing.assert_allclose(deformation.fading(4.0), [*(3 * at**2 - 2 * at**3), 1.0])
    assert deformation.fading(100.0)[-1] == 1.0  # the deepest that there is
    everything = np.ones(SIZE**2, dtype=bool)
    assert RegionDeformation(VERTICES, FACES, everything, handles).fading(4.0).tolist() == [1.0] * 5


def test_a_region_of_handles_alone_moves_with_them():
    region = np.zeros(SIZE**2, dtype=bool)
    region[MIDDLE] = True
    moved = RegionDeformation(VERTICES, FACES, region, np.array([MIDDLE])).displacement(np.array([[1.0, 2, 3]]))
    assert np.flatnonzero(moved.any(axis=1)).tolist() == [MIDDLE]


def test_no_handles_or_handles_outside_are_an_error():
    with pytest.raises(ValueError, match="at least one handle"):
        RegionDeformation(VERTICES, FACES, REGION, np.array([], dtype=int))
    with pytest.raises(ValueError, match="1 of 2 lie outside"):
        RegionDeformation(VERTICES, FACES, REGION, np.array([0, MIDDLE]))


def test_reach_is_measured_along_the_edges():
    """The diagonals of the cells go one way only: from the corner, (2, 2) is 4 off, not 2.8."""
    near = within_reach(VERTICES, FACES, np.array([0]), 2.5).reshape(SIZE, SIZE)
    assert {tuple(place) for place in np.argwhere(near).tolist()} == {(0, 0), (0, 1), (0, 2), (1, 0), (2, 0), (1, 1)}
    both = within_reach(VERTICES, FACES, np.array([0, SIZE**2 - 1]), 0.0)
    assert np.flatnonzero(both).tolist() == [0, SIZE**2 - 1]
