"""A sheet that was pushed over itself opens again, and nothing else changes."""

import numpy as np
import pytest
from scipy import sparse

from sketchwidget.geometry.unfolding import Unfolding

SIDE = 21
CORNER = np.arange(SIDE**2).reshape(SIDE, SIDE)[:-1, :-1].ravel()
FACES = np.concatenate(
    [
        np.stack([CORNER, CORNER + 1, CORNER + SIDE + 1], axis=1),
        np.stack([CORNER, CORNER + SIDE + 1, CORNER + SIDE], axis=1),
    ]
)
X, Y = (axis.ravel() for axis in np.meshgrid(np.arange(SIDE), np.arange(SIDE)))
SHEET = np.stack([X, Y, 0.2 * np.sin(X)], axis=1).astype(float)
MIDDLE, BORDER = (X == 10) & (abs(Y - 10) < 4), (X % 20 == 0) | (Y % 20 == 0)
HELD = np.flatnonzero(MIDDLE | BORDER)


@pytest.fixture(scope="module")
def unfolding():
    handles = sparse.identity(SIDE**2, format="csr")[HELD]
    return Unfolding(SHEET, FACES, sparse.identity(SIDE**2, format="csr"), FACES, handles, 1e-3)


def pushed(far):
    """A hill of displacement that takes the middle a way to the right, but has faded 3 from there."""
    away = np.hypot(X - 10, np.maximum(abs(Y - 10) - 3, 0))
    along = far * np.clip(1 - away / 3, 0, 1) ** 2
    return np.stack([along, 0 * along], axis=1)


def turned_over(displacement):
    corners = (SHEET[:, :2] + displacement)[FACES]
    (x, y), (u, v) = np.moveaxis(corners[:, 1:] - corners[:, :1], (1, 2), (0, 1))
    return int((x * v - y * u < 0).sum())


@pytest.mark.parametrize("far", [4.0, 7.0])
def test_folds_open_and_handles_stay(unfolding, far):
    displaced = pushed(far)
    assert turned_over(displaced) > 20
    opened = unfolding(SHEET, displaced, np.ones(len(HELD), dtype=bool))
    assert turned_over(opened) == 0
    np.testing.assert_allclose(opened[HELD], displaced[HELD], atol=0.05)


def whirled(turns):
    """The middle turned by an angle, which fades towards the border."""
    away = np.hypot(X - 10, Y - 10) / 10
    there = SHEET[:, :2] @ [1, 1j] - (10 + 10j)
    moves = there * (np.exp(1j * turns * np.clip(1 - away, 0, 1)) - 1)
    return np.stack([moves.real, moves.imag], axis=1)


def test_folds_open_where_the_sheet_has_turned_far(unfolding):
    displaced = whirled(3.2)
    free = (np.hypot(X - 10, Y - 10) > 4) & (np.hypot(X - 10, Y - 10) < 9)
    displaced[free] *= 0.6  # what lies between keeps behind, and folds
    assert turned_over(displaced) > 20
    opened = unfolding(SHEET, displaced, np.ones(len(HELD), dtype=bool))
    assert turned_over(opened) == 0
    np.testing.assert_allclose(opened[HELD], displaced[HELD], atol=0.05)


def test_a_sheet_seen_from_behind_opens_too(unfolding):
    displaced = pushed(5.0)
    behind = SHEET * [-1, 1, -1]
    opened = unfolding(behind, displaced * [-1, 1], np.ones(len(HELD), dtype=bool))
    np.testing.assert_allclose(opened * [-1, 1], unfolding(SHEET, displaced, np.ones(len(HELD), dtype=bool)), atol=1e-6)


def test_far_from_a_fold_nothing_moves(unfolding):
    displaced = pushed(5.0)
    opened = unfolding(SHEET, displaced, np.ones(len(HELD), dtype=bool))
    assert (opened != displaced).any() and (opened == displaced)[(X < 2) | (X > 18)].all()


def test_handles_that_are_not_held_give_way(unfolding):
    displaced = pushed(7.0)
    free = unfolding(SHEET, displaced, BORDER[HELD])
    assert turned_over(free) == 0
    assert np.abs(free - displaced)[MIDDLE].max() > 0.5


def test_with_nothing_held_all_of_a_sheet_opens(unfolding):
    displaced = np.stack([1.5 * (X % 2), 0 * X], axis=1)
    assert turned_over(displaced) > 300
    opened = unfolding(SHEET, displaced, np.zeros(len(HELD), dtype=bool))
    assert turned_over(opened) == 0 and np.abs(opened - displaced).max() < 10


@pytest.mark.parametrize("angle", [0.0, 1.0, 3.0])
def test_what_does_not_fold_is_left_alone(unfolding, angle):
    turn = 0.6 * np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    displaced = SHEET[:, :2] @ turn - SHEET[:, :2]
    np.testing.assert_array_equal(unfolding(SHEET, displaced, np.ones(len(HELD), dtype=bool)), displaced)


def test_triangles_seen_edge_on_do_not_count(unfolding):
    upright = np.stack([0.05 * X, Y, X], axis=1).astype(float)
    displaced = np.stack([-0.1 * X, 0 * X], axis=1)
    np.testing.assert_array_equal(unfolding(upright, displaced, np.ones(len(HELD), dtype=bool)), displaced)
