from __future__ import annotations

import pytest

from sketchwidget.sketch import Sketch
from sketchwidget.widgets.status import Status, expected_next, sentence

DOT = [(0.5, 0.5)]


def test_an_empty_sketch_asks_for_an_outline():
    assert "outline" in expected_next(Sketch(()))


def test_what_is_drawn_is_not_asked_for_again():
    sketch = Sketch(()).with_segment("silhouette", DOT).with_segment("left_eye_upper", DOT)
    assert expected_next(sketch) == "Still to draw: brows, nose and mouth, in any order."


def test_of_one_line_no_order_is_said():
    sketch = Sketch(())
    for name in ("silhouette", "left_brow", "left_eye_upper", "nose"):
        sketch = sketch.with_segment(name, DOT)
    assert expected_next(sketch) == "Still to draw: mouth."


def test_a_whole_face_asks_for_nothing():
    sketch = Sketch(())
    for name in ("silhouette", "left_brow", "left_eye_upper", "nose", "mouth_upper"):
        sketch = sketch.with_segment(name, DOT)
    assert "Still" not in expected_next(sketch)


def test_figures_show_the_mode_and_the_known_timings():
    status = Status()
    status.show_figures("initial", {"sketch": 1.0, "inference": 9.4, "total": 14.0})
    assert status._figures.value == "Initial · inference 9 ms · total 14 ms"


@pytest.mark.parametrize(
    ("error", "said"),
    [(ValueError("line 3 is  cut\nshort"), "Line 3 is cut short."), (KeyError(), "KeyError."), (OSError("No!"), "No!")],
)
def test_errors_are_said_as_sentences(error, said):
    assert sentence(error) == said
