import numpy as np
import pytest

from sketchwidget.sketch import resample
from sketchwidget.sketch.returning import turned_back, without_returns

ACROSS = np.stack([np.linspace(0.2, 0.6, 81), np.full(81, 0.5)], axis=1)


def test_the_way_half_back_is_left_out():
    drawn = resample(np.concatenate([ACROSS, ACROSS[:40:-1] + np.array([0, 0.001])]), 160)
    for line in (drawn, drawn[::-1]):
        kept = without_returns(line, 0.004)
        assert sorted(kept[[0, -1], 0]) == pytest.approx([0.2, 0.6], abs=0.012)
        assert np.linalg.norm(np.diff(kept, axis=0), axis=1).sum() == pytest.approx(0.4, abs=0.02)


def test_what_runs_beside_itself_the_same_way_or_further_off_stays():
    turn = np.linspace(0, 2 * np.pi, 120)
    ring = 0.5 + 0.1 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    hairpin = resample(np.concatenate([ACROSS, ACROSS[::-1] + np.array([0, 0.02])]), 160)
    for line in (ACROSS, ring, hairpin):
        np.testing.assert_array_equal(without_returns(line, 0.004), line)


def test_a_hook_by_hand():
    """Of four edges to the right, the third runs back by 0.02."""
    former = np.stack([0.02 * np.arange(5), np.zeros(5)], axis=1)
    hook = np.array([[0, 0], [0.02, 0], [0.04, 0], [0.02, 0.005], [0.08, 0.01]])
    assert turned_back(hook, former, 0.05) == pytest.approx(0.02)
    assert turned_back(former, former, 0.05) == 0
    assert turned_back(hook, former, 0.001) == 0  # nothing so near runs the other way


def test_neither_a_line_turned_as_a_whole_nor_a_tip_is_a_hook():
    turn = np.linspace(np.pi, 0, 30)
    arch = np.stack([np.cos(turn), np.sin(turn)], axis=1) * [0.05, 0.02]
    assert turned_back(-arch, arch, 0.03) == 0  # runs the other way everywhere
    assert turned_back(arch * [1, -1], arch, 0.03) == 0  # a lid that closes
    assert turned_back(arch * [0.1, 1], arch, 0.1) == pytest.approx(0, abs=1e-9)  # a thin tip
