"""Recorded gestures; how files are read and written is tested with the drawings, which share it."""

import json

import numpy as np
import pytest

from sketchwidget.gesture.recordings import FILE, Recording

POINTS = [[0.1, 0.2, 0.5, 0.0], [0.3, 0.4, 0.75, 8.3]]


def test_what_is_written_is_read(tmp_path):
    path = tmp_path / "anna.jsonl"
    given = [Recording(POINTS, "up roll 2"), Recording(POINTS)]
    for recording in given:
        FILE.append(path, recording)
    assert FILE.read(path) == given
    header, first, second = map(json.loads, path.read_text().splitlines())
    assert header == {"format": "sketchwidget gestures", "version": 1}
    assert first == {"name": "up roll 2", "points": POINTS} and second["name"] is None
    FILE.take_back(path, given[1])
    assert FILE.read(path) == given[:1]


def test_an_unknown_name_or_a_stroke_without_pressure_is_refused(tmp_path):
    with pytest.raises(ValueError, match="given 'circle'"):
        Recording(POINTS, "circle")
    with pytest.raises(ValueError, match="pressure and milliseconds"):
        Recording(np.array(POINTS)[:, :2], "line")
    path = tmp_path / "a.jsonl"
    path.write_text('{"format": "sketchwidget gestures", "version": 1}\n{"name": "line"}\n')
    with pytest.raises(ValueError, match=r"a\.jsonl, line 2 is no gesture"):
        FILE.read(path)
