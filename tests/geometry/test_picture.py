"""Shaded pictures."""

import numpy as np
import pytest
import trimesh

from sketchwidget.geometry import View
from sketchwidget.geometry.picture import picture

BALL = trimesh.creation.icosphere(subdivisions=3, radius=50)
CLAY = np.full((len(BALL.vertices), 3), 0.7)


def test_a_ball_covers_its_disc_and_nothing_else():
    shown = picture(BALL.vertices, BALL.faces, CLAY, size=200)
    covered = (shown < 255).any(axis=2)
    assert abs(covered.mean() - np.pi * 0.2**2) < 0.004  # 50 mm are 0.2 of the canvas
    assert not covered[0].any() and not covered[:, 0].any()


def test_what_is_nearer_hides_what_is_behind():
    red, blue = np.array([1.0, 0, 0]), np.array([0, 0, 1.0])
    vertices = np.concatenate([BALL.vertices + np.array([0, 0, 80]), BALL.vertices])
    faces = np.concatenate([BALL.faces, BALL.faces + len(BALL.vertices)])
    colors = np.concatenate([CLAY * red, CLAY * blue])
    middle = picture(vertices, faces, colors, size=64)[32, 32]
    assert middle[0] > 0 and middle[2] == 0
    turned = picture(vertices, faces, colors, View(np.diag([-1.0, 1, -1])), size=64)[32, 32]
    assert turned[2] > 0 and turned[0] == 0


def test_sizes_that_make_no_picture_are_refused():
    with pytest.raises(ValueError, match="given 0"):
        picture(BALL.vertices, BALL.faces, CLAY, size=0)
