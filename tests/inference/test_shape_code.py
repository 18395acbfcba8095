"""The shape of a drawing's lines as a few coefficients, and back."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sketchwidget.inference.shape_code import COUNTS, LINES, ShapeModel, sample, sample_indices, split_lines, weighted
from sketchwidget.sketch import FEATURES, SILHOUETTE

P, Q, R, POINTS = 4, 3, 5, 60 + 12 * len(FEATURES)
seeds = st.integers(0, 2**32 - 1)


def random_model(seed):
    random = np.random.default_rng(seed)
    return ShapeModel(
        mean=random.uniform(0.2, 0.8, 2 * POINTS).astype(np.float32),
        core=random.normal(0, 0.03, (2 * POINTS, P, Q)).astype(np.float32),
        identity_mean=random.normal(0, 1, P).astype(np.float32),
        identity_std=random.uniform(0.3, 0.6, P).astype(np.float32),
        expression_mean=random.normal(0, 1, Q).astype(np.float32),
        expression_std=random.uniform(0.3, 0.6, Q).astype(np.float32),
        detail_mean=random.normal(0, 1, 3 * POINTS).astype(np.float32),
        detail_axes=random.normal(0, 0.01, (3 * POINTS, R)).astype(np.float32),
        detail_trust=np.ones(R, np.float32),
    )


MODEL = random_model(0)
EVERYTHING = np.ones(POINTS)


def drawn(seed, count=3):
    """Codes from the prior, and the points of their drawings."""
    codes = np.random.default_rng(seed).normal(size=(count, MODEL.size)).astype(np.float32)
    return codes, MODEL.decode(codes)


def directions(codes):
    """Weights u and v of unit length: twice the one and half the other are the same drawing."""
    u = MODEL.identity_mean + MODEL.identity_std * codes[:, :P]
    v = MODEL.expression_mean + MODEL.expression_std * codes[:, P:]
    return [weights / np.linalg.norm(weights, axis=1, keepdims=True) for weights in (u, v)]


def test_points_of_a_code_are_those_of_the_bilinear_model():
    u, v = MODEL.identity_mean.copy(), MODEL.expression_mean.copy()
    np.testing.assert_allclose(
        MODEL.decode(np.zeros((1, P + Q)))[0].ravel(), MODEL.mean + MODEL.core @ v @ u, atol=1e-5
    )
    code = np.zeros((1, P + Q))
    code[0, [1, P + 2]] = 2, -1
    u[1] += 2 * MODEL.identity_std[1]
    v[2] -= MODEL.expression_std[2]
    points = MODEL.decode(code)
    assert points.shape == (1, POINTS, 2)
    np.testing.assert_allclose(points[0].ravel(), MODEL.mean + MODEL.core @ v @ u, atol=1e-5)


@given(seeds)
@settings(max_examples=30)
def test_a_code_of_which_all_points_are_seen_is_found_again(seed):
    codes, points = drawn(seed)
    found = MODEL.encode(points, np.tile(EVERYTHING, (3, 1)))
    assert found.shape == codes.shape and found.dtype == np.float32
    # Within the noise that drawn lines have for the model.
    assert np.linalg.norm(MODEL.decode(found) - points, axis=2).mean(axis=1).max() < 0.01
    for ours, theirs in zip(directions(found), directions(codes), strict=True):
        assert (np.abs((ours * theirs).sum(axis=1)) > 0.99).all()


@given(seeds)
@settings(max_examples=10)
def test_nothing_seen_gives_zeros(seed):
    _, points = drawn(seed)
    np.testing.assert_array_equal(MODEL.encode(points, np.zeros((3, POINTS))), 0)


@pytest.mark.parametrize("hidden", ["nose", "left_eye_upper", SILHOUETTE])
def test_lines_that_are_not_seen_are_filled_in(hidden):
    _, points = drawn(1, count=20)
    away = np.concatenate([np.full(count, name == hidden) for name, count in COUNTS.items()])
    found = MODEL.encode(np.where(away[:, None], 7.0, points), np.tile(~away, (20, 1)))
    filled, mean = (MODEL.decode(codes)[:, away] for codes in (found, np.zeros_like(found)))
    error, of_the_mean = (np.linalg.norm(lines - points[:, away], axis=2).mean(axis=1) for lines in (filled, mean))
    assert error.max() < 2e-3 and of_the_mean.min() > 0.01


def test_points_that_count_less_are_followed_less():
    _, (one, other) = drawn(2, count=2)
    nose = np.concatenate([np.full(count, name == "nose") for name, count in COUNTS.items()])
    mixed = np.where(nose[:, None], other, one)

    def misfit(weight):
        found = MODEL.decode(MODEL.encode(mixed[None], np.where(nose, weight, 0.02)[None]))[0]
        return np.linalg.norm(found - other, axis=1)[nose].mean()

    assert misfit(0.0) > misfit(0.02) > misfit(0.2) > misfit(1.0)
    assert misfit(1.0) < 0.7 * misfit(0.0)


def test_each_drawing_of_a_batch_is_coded_for_itself():
    _, points = drawn(3, count=5)
    seen = np.random.default_rng(4).random((5, POINTS)) < 0.6
    together = MODEL.encode(points, seen)
    for number in range(5):
        alone = MODEL.encode(points[[number]], seen[[number]])[0]
        np.testing.assert_allclose(alone, together[number], atol=2e-3)


def test_sample_takes_60_points_of_the_outline_and_12_of_each_feature():
    random = np.random.default_rng(0)
    lines = {name: random.random((int(random.integers(13, 60)), 2)) for name in FEATURES}
    lines[SILHOUETTE] = random.random((181, 2))
    points = sample(lines)
    assert points.shape == (POINTS, 2) and list(COUNTS.values()) == [60, *[12] * len(FEATURES)]
    by_line = split_lines(points)
    assert tuple(by_line) == LINES
    np.testing.assert_array_equal(by_line[SILHOUETTE], lines[SILHOUETTE][:180:3])
    for name in FEATURES:
        np.testing.assert_array_equal(by_line[name][[0, -1]], lines[name][[0, -1]])
        at = [int(np.flatnonzero((lines[name] == point).all(axis=1))[0]) for point in by_line[name]]
        assert (np.diff(at) > 0).all() and np.ptp(np.diff(at)) <= 1


@given(st.integers(12, 400))
def test_sampled_points_of_a_line_are_its_ends_and_evenly_between(length):
    at = sample_indices(length)
    assert (at[0], at[-1]) == (0, length - 1) and len(at) == 12
    assert np.abs(np.diff(at) - (length - 1) / 11).max() <= 1


@given(seeds)
@settings(max_examples=20)
def test_a_description_is_coefficients_details_and_that_points_are_known(seed):
    _, points = drawn(seed)
    seen = np.tile(EVERYTHING, (3, 1))
    seen[:, ::7] = 0
    described = MODEL.describe(points, seen)
    assert described.shape == (3, P + Q + R + 1) and described.dtype == np.float32
    np.testing.assert_array_equal(described[:, : MODEL.size], MODEL.encode(points, seen))
    np.testing.assert_array_equal(described[:, MODEL.size : -1], MODEL.details(points, seen))
    assert not described[:, -1].any()


def test_details_are_linear_in_the_points_and_in_what_is_seen():
    points = MODEL.mean.reshape(1, -1, 2) + np.zeros((3, 1, 1), np.float32)
    points[1, 4] += (0.005, -0.01)  # one and two units of the drawing noise
    seen = np.ones((3, POINTS))
    seen[2, 9] = 0.25
    details = MODEL.details(points, seen)
    axes = MODEL.detail_axes
    np.testing.assert_allclose(details[1] - details[0], axes[8] - 2 * axes[9], atol=1e-4)
    np.testing.assert_allclose(details[2] - details[0], -0.75 * axes[2 * POINTS + 9], atol=1e-4)


def test_what_is_not_seen_tells_nothing_but_that():
    _, points = drawn(0)
    seen = np.tile(EVERYTHING, (3, 1))
    seen[:, 5:20] = 0
    elsewhere = points.copy()
    elsewhere[:, 5:20] = 7.0
    np.testing.assert_array_equal(MODEL.details(points, seen), MODEL.details(elsewhere, seen))


def test_a_point_far_off_counts_no_more_than_eight_standard_deviations():
    _, points = drawn(0)
    points[0, 5] += 100.0
    assert np.abs(MODEL.details(points, np.tile(EVERYTHING, (3, 1)))[0]).max() == 8.0


def test_points_count_by_how_much_they_are_seen():
    points = MODEL.mean.reshape(1, -1, 2).copy()
    points[0, 3] += (0.01, 0.0)
    for share in (0.0, 0.5, 1.0):
        seen = np.full((1, POINTS), share)
        off = weighted(MODEL.mean, points, seen)[0]
        assert off[6] == pytest.approx(2 * share, abs=1e-4) and not np.delete(off[: 2 * POINTS], 6).any()
        np.testing.assert_array_equal(off[2 * POINTS :], share)


@given(seeds)
@settings(max_examples=20)
def test_from_near_coefficients_on_one_round_is_enough(seed):
    _, points = drawn(seed)
    every = np.tile(EVERYTHING, (3, 1))
    found = MODEL.encode(points, every)
    near = MODEL.encode(points + np.random.default_rng(seed).normal(0, 0.002, points.shape), every)
    once = MODEL.encode(points, every, near=near)
    assert np.abs(MODEL.decode(once) - points).mean() <= 1.2 * np.abs(MODEL.decode(found) - points).mean() + 1e-4
