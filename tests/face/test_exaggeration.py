"""Levels of exaggeration."""

import numpy as np
import pytest

from sketchwidget.face import PARTS
from sketchwidget.face.exaggeration import LEVELS, Exaggeration


@pytest.fixture(scope="module")
def rest(model):
    """Coarse vertices of the mean face."""
    return model.coarse(model.mean_identity, model.expression_weights("neutral"))


@pytest.fixture(scope="module")
def exaggeration(model, rest):
    return Exaggeration(model.template, rest)


@pytest.fixture(scope="module")
def levels(exaggeration, rest):
    return exaggeration(rest, rest[None])[:, 0]


def test_the_first_level_is_the_head_itself(levels, rest):
    assert levels.shape == (LEVELS, *rest.shape) and LEVELS == 4
    np.testing.assert_allclose(levels[0], rest, rtol=1e-6)


def test_eyes_mouth_and_what_hangs_in_it_stay_where_they_are(model, levels):
    still = model.template.parts != PARTS.index("skin")
    np.testing.assert_allclose(levels[:, still], np.repeat(levels[:1, still], LEVELS, axis=0), atol=1e-4)
    fine = [model.template.subdivision @ level for level in levels]
    for name in ("left_eye_upper", "mouth_lower"):
        path = model.curves[name]
        assert max(np.abs(level[path] - fine[0][path]).max() for level in fine) < 0.1


def test_nose_and_ears_grow_with_every_level(model, levels):
    fine = np.stack([model.template.subdivision @ level for level in levels])
    nose = fine[:, model.landmarks[30], 2] - fine[:, model.landmarks[27], 2]  # tip before root
    ears = [np.ptp(level[model.curves["left_ear"]], axis=0).max() for level in fine]
    assert (np.diff(nose) > 0.5).all() and (np.diff(ears) > 0.5).all()


def test_the_head_is_not_inflated(model, levels):
    area = [np.ptp(level, axis=0).prod() for level in levels]
    assert max(area) < 1.35 * area[0]


def test_the_first_level_scales_nothing_and_none_scales_wildly(exaggeration, rest):
    scales = exaggeration.scales(rest)
    np.testing.assert_allclose(scales[0], 1.0)
    assert (scales > 0.3).all() and (scales < 3.0).all()


def test_level_by_level_scales_are_powers_of_one_curvature(exaggeration, rest):
    """Before they are made relative to their mean, the logarithms of two levels are proportional."""
    one, two = (np.log(scales) for scales in exaggeration.scales(rest)[[1, 2]])
    assert np.corrcoef(one, two)[0, 1] > 0.999
