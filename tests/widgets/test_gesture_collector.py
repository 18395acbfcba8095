"""The recorder of gestures, without a page."""

from collections import Counter

import numpy as np
import pytest

from sketchwidget import GESTURES, GestureCollector
from sketchwidget.gesture.recordings import FILE
from sketchwidget.widgets import gesture_collector

STROKE = np.array([[0.1, 0.2, 1.5, 0.0], [0.3, 0.4, 0.5, 9.0], [0.4, 0.4, 0.5, 8.0]])  # as a bad tablet has it


@pytest.fixture
def path(tmp_path):
    return tmp_path / "anna.jsonl"


def draw(collector):
    collector._on_stroke(STROKE, "pen", False)


def test_every_gesture_is_asked_for_as_often_as_the_others(path):
    collector = GestureCollector(path)
    asked = []
    for _ in range(2 * len(GESTURES)):
        asked.append(collector.asked)
        draw(collector)
    assert set(Counter(asked[: len(GESTURES)])) == set(GESTURES) and set(Counter(asked).values()) == {2}
    kept = FILE.read(path)
    assert [recording.name for recording in kept] == asked
    np.testing.assert_allclose(kept[0].points[:, 2:], [[1.0, 0.0], [0.5, 9.0], [0.5, 9.0]])


def test_undo_takes_strokes_back_and_asks_again(path):
    collector = GestureCollector(path)
    first = collector.asked
    draw(collector)
    collector._undo.click()
    assert collector.asked == first and FILE.read(path) == []
    collector._undo.click()
    assert "Nothing to undo" in collector._status.message


def test_what_is_skipped_is_not_asked_for_at_once_and_comes_again(path):
    collector = GestureCollector(path)
    for _ in GESTURES[1:]:
        draw(collector)
    (last,) = set(GESTURES) - {recording.name for recording in FILE.read(path)}
    assert collector.asked == last  # all others were drawn once
    collector._skip.click()
    assert collector.asked != last and len(FILE.read(path)) == len(GESTURES) - 1
    assert collector.asked in collector._status.message and "gesture" in collector._skip.tooltip
    draw(collector)
    assert collector.asked == last


def test_opened_again_it_goes_on(path):
    collector = GestureCollector(path)
    draw(collector)
    again = GestureCollector(path)
    assert repr(again).endswith("1 gesture kept)") and again.asked != FILE.read(path)[0].name
    again._undo.click()  # strokes of another sitting stay
    assert len(FILE.read(path)) == 1


def test_what_is_not_kept_is_told(path, monkeypatch):
    collector = GestureCollector(path)

    def full_disk(*_):
        raise OSError("No space left on device")

    monkeypatch.setattr(gesture_collector.FILE.__class__, "append", full_disk)
    asked = collector.asked
    draw(collector)
    assert "This stroke is not kept: No space left" in collector._status.message and collector.asked == asked
