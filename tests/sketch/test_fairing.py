"""Drawn lines become ones that handle points can be on."""

import numpy as np
import pytest

from sketchwidget.sketch import Piece
from sketchwidget.sketch.fairing import fair, faired
from sketchwidget.sketch.piece import handle_points

AT = np.arange(25)
LINE = np.stack([0.3 + 0.01 * AT, np.full(25, 0.5)], axis=1)


def pieces(middle):
    """A straight line of three pieces, with other points in the middle one, from place 8 to place 16."""
    return Piece("nose", middle, np.linspace(8, 16, len(middle))), [
        Piece("nose", LINE[part], AT[part]) for part in (slice(0, 8), slice(17, 25))
    ]


def turns(line):
    """By how many degrees a line (n, 2) turns at each of its inner points."""
    return np.diff(np.unwrap(np.degrees(np.arctan2(*np.diff(line, axis=0).T[::-1])), period=360))


def coarse(seed):
    """Handle points that a step of subdivision makes of random vertices."""
    vertices = np.cumsum(np.random.default_rng(seed).normal(0.02, 0.005, (13, 2)), axis=0)
    fine = np.empty((23, 2))
    fine[1::2] = (vertices[1:-1] * 6 + vertices[:-2] + vertices[2:])[:] / 8
    fine[::2] = (vertices[1:] + vertices[:-1])[:12] / 2
    return fine[1:-1]  # from vertex to vertex


@pytest.mark.parametrize("seed", range(5))
def test_what_a_subdivided_line_can_be_stays(seed):
    line = coarse(seed)
    at = np.arange(len(line))
    found = fair(at, line, [], 2)(at)
    size = np.linalg.norm(np.diff(line, axis=0), axis=1).max()
    assert np.linalg.norm(found - line, axis=1).max() < 0.15 * size


def test_a_cubic_is_kept():
    x = np.linspace(-1, 1, 33)[:, None]
    drawn, kept = pieces(np.array([[0.38, 0.5], [0.46, 0.5]]))
    curve = np.concatenate([x, x**3 - 0.3 * x], axis=1)
    np.testing.assert_allclose(faired(Piece("nose", curve, np.linspace(0, 8, 33)), [], 2).points, curve, atol=2e-3)
    np.testing.assert_allclose(faired(drawn, kept, 2).points[:, 1], 0.5, atol=1e-6)


def test_a_zigzag_finer_than_the_mesh_is_evened_out():
    waves = np.stack([np.linspace(0.38, 0.46, 65), 0.5 + 0.01 * (np.abs(np.arange(65) % 8 - 4) / 2 - 1)], axis=1)
    drawn, kept = pieces(waves)
    assert np.abs(faired(drawn, kept, 2).points[:, 1] - 0.5).max() < 0.004


def test_a_hill_stays_and_joins_without_a_corner():
    x = np.linspace(0, 1, 65)
    hill = np.stack([0.38 + 0.08 * x, 0.5 - 0.03 * np.sin(np.pi * x)], axis=1)
    drawn, kept = pieces(hill)
    found = faired(drawn, kept, 2)
    assert found.low == 8 and found.high == 16
    assert found.points[:, 1].min() == pytest.approx(0.47, abs=0.003)
    corners = [
        np.abs(turns(line)[6:8]).max() for line in [handle_points([piece, *kept], 25) for piece in (drawn, found)]
    ]
    assert corners[1] < 0.5 * corners[0]


def test_fewer_knots_make_a_smoother_line():
    waves = np.stack([np.linspace(0.38, 0.46, 65), 0.5 + 0.01 * np.sin(np.linspace(0, 4 * np.pi, 65))], axis=1)
    drawn, kept = pieces(waves)
    bends = [np.abs(np.diff(handle_points([faired(drawn, kept, step)], 25)[8:17], 2, axis=0)).max() for step in (2, 4)]
    assert bends[1] < 0.7 * bends[0]
