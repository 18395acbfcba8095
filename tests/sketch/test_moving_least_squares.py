"""Moving least squares, after Schaefer, McPhail and Warren."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sketchwidget.sketch.moving_least_squares import affine, similarity

seeds = st.integers(0, 2**32 - 1)
SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)


@given(seeds)
def test_affine_motions_are_reproduced(seed):
    random = np.random.default_rng(seed)
    linear, shift = random.normal(size=(2, 2)), random.normal(size=2)
    points, controls = random.uniform(-1, 2, (50, 2)), np.concatenate([SQUARE, random.uniform(0, 1, (3, 2))])
    np.testing.assert_allclose(affine(points, controls, controls @ linear + shift), points @ linear + shift, atol=1e-5)


@given(seeds)
def test_similarities_are_reproduced_even_from_two_controls(seed):
    random = np.random.default_rng(seed)
    angle, scale = random.uniform(0, 2 * np.pi), random.uniform(0.2, 3)
    turn = scale * np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    points, controls = random.uniform(-1, 2, (50, 2)), SQUARE[:2]
    np.testing.assert_allclose(similarity(points, controls, controls @ turn + 1), points @ turn + 1, atol=1e-5)


@pytest.mark.parametrize("deform", [affine, similarity])
@given(seeds)
def test_controls_go_where_they_are_moved_and_their_surroundings_with_them(deform, seed):
    random = np.random.default_rng(seed)
    controls = SQUARE + random.normal(0, 0.1, SQUARE.shape)
    moved = controls + random.normal(0, 0.1, controls.shape)
    np.testing.assert_allclose(deform(controls, controls, moved), moved, atol=1e-12)
    np.testing.assert_allclose(deform(controls + 1e-4, controls, moved), moved, atol=1e-3)


@pytest.mark.parametrize("deform", [affine, similarity])
@given(seeds)
def test_nothing_moves_if_no_control_does(deform, seed):
    points = np.random.default_rng(seed).uniform(-1, 2, (50, 2))
    np.testing.assert_allclose(deform(points, SQUARE, SQUARE), points, atol=1e-6)


def test_controls_that_fix_no_motion_are_refused():
    with pytest.raises(ValueError, match="not all on one line"):
        affine(SQUARE, SQUARE[[0, 0, 2]], SQUARE[:3])
    with pytest.raises(ValueError, match="two places"):
        similarity(SQUARE, SQUARE[[0, 0]], SQUARE[:2])
    with pytest.raises(ValueError, match="as many places"):
        affine(SQUARE, SQUARE, SQUARE[:3])
