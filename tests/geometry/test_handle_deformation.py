"""Laplacian editing against a direct solution, and its invariances."""

import igl
import numpy as np
import pytest
from scipy import sparse

from sketchwidget.geometry.handle_deformation import HandleDeformation

SOFT = 1e-9


@pytest.fixture(scope="module")
def sheet():
    """A bumpy sheet (n, 3), its triangles, and handles on its border, its middle and between two vertices."""
    x, y = np.meshgrid(np.linspace(0, 10, 12), np.linspace(0, 10, 12))
    vertices = np.stack([x.ravel(), y.ravel(), np.sin(x).ravel() * np.cos(y).ravel()], axis=1)
    corner = np.arange(144).reshape(12, 12)[:-1, :-1].ravel()
    faces = np.concatenate(
        [np.stack([corner, corner + 1, corner + 13], axis=1), np.stack([corner, corner + 13, corner + 12], axis=1)]
    )
    border = np.flatnonzero((x.ravel() % 10 == 0) | (y.ravel() % 10 == 0))
    rows = [*border, 78]
    handles = sparse.lil_matrix((len(rows) + 1, 144))
    handles[np.arange(len(rows)), rows] = 1
    handles[-1, 30], handles[-1, 31] = 0.25, 0.75
    return vertices, faces, handles.tocsr()


def test_it_is_the_least_squares_solution(sheet):
    vertices, faces, handles = sheet
    softness, anchor = 0.1, 1e-3
    moves = np.random.default_rng(0).normal(size=(handles.shape[0], 2))
    areas = igl.massmatrix(vertices, faces, igl.MASSMATRIX_TYPE_BARYCENTRIC).diagonal()
    rows = np.concatenate(
        [
            igl.cotmatrix(vertices, faces).toarray() / np.sqrt(areas)[:, None],
            np.sqrt(anchor * areas)[:, None] * np.eye(144),
            handles.toarray() / np.sqrt(softness),
        ]
    )
    wanted = np.concatenate([np.zeros((288, 2)), moves / np.sqrt(softness)])
    expected = np.linalg.lstsq(rows, wanted, rcond=None)[0]
    deformation = HandleDeformation(vertices, faces, handles, softness, anchor)
    np.testing.assert_allclose(deformation(moves), expected, atol=1e-4)


def test_stiff_handles_reach_their_targets(sheet):
    moves = np.random.default_rng(1).normal(size=(sheet[2].shape[0], 2))
    np.testing.assert_allclose(sheet[2] @ HandleDeformation(*sheet, SOFT, 1e-6)(moves), moves, atol=1e-3)


def test_a_shift_of_all_handles_is_a_shift_of_the_mesh(sheet):
    moves = np.tile([3.0, -2.0], (sheet[2].shape[0], 1))
    np.testing.assert_allclose(HandleDeformation(*sheet, SOFT, 1e-12)(moves), np.tile([3.0, -2.0], (144, 1)), atol=1e-3)


def test_free_handles_are_as_if_they_were_none(sheet):
    vertices, faces, handles = sheet
    moves = np.random.default_rng(2).normal(size=(handles.shape[0], 2))
    few = np.arange(handles.shape[0]) % 3 == 0
    expected = HandleDeformation(vertices, faces, handles[few], 0.1, 1e-3)(moves[few])
    some = np.where(few[:, None], moves, np.nan)
    np.testing.assert_allclose(HandleDeformation(vertices, faces, handles, 0.1, 1e-3)(some), expected, atol=1e-4)


def test_the_usual_handles_give_the_same_as_a_solution(sheet):
    vertices, faces, handles = sheet
    moves = np.random.default_rng(3).normal(size=(handles.shape[0], 2))
    usual = np.arange(handles.shape[0]) % 2 == 0
    moves[~usual] = np.nan
    expected = HandleDeformation(vertices, faces, handles, 0.1, 1e-3)(moves)
    np.testing.assert_allclose(HandleDeformation(*sheet, 0.1, 1e-3, usual)(moves), expected, atol=1e-4)


def test_with_no_handle_given_nothing_moves(sheet):
    moves = np.full((sheet[2].shape[0], 2), np.nan)
    assert not HandleDeformation(*sheet, SOFT, 1e-6)(moves).any()


def test_turning_reproduces_a_similarity_of_the_plane(sheet):
    """Linear editing cannot: with the border turned by 30 degrees, its bumps lean over."""
    vertices, faces, handles = sheet
    vertices = vertices @ np.array([[1, 0.0, 0], [0, 1, 0], [0.4, 0.3, 1]])  # bumps that show in the plane
    turn = 1.3 * np.array([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]])
    moves = (handles @ vertices[:, :2]) @ turn.T - handles @ vertices[:, :2]
    deformation = HandleDeformation(vertices, faces, handles, 1e-6, 1e-9)
    errors = [
        np.abs(vertices[:, :2] + moved - vertices[:, :2] @ turn.T).max()
        for moved in (deformation(moves), deformation.turning(vertices, moves, rounds=8))
    ]
    assert errors[1] < 0.2 * errors[0]


@pytest.mark.parametrize(("softness", "anchor"), [(0.0, 1.0), (1.0, -1.0)])
def test_bad_weights_are_an_error(sheet, softness, anchor):
    with pytest.raises(ValueError, match="positive"):
        HandleDeformation(*sheet, softness, anchor)


def test_handles_of_another_mesh_are_an_error(sheet):
    with pytest.raises(ValueError, match="given"):
        HandleDeformation(sheet[0], sheet[1], sheet[2][:, :5], 1.0, 1.0)
