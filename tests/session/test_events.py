import json

import numpy as np
import pytest

from sketchwidget.session import Cancel, Clear, Draw, Erase, Mode, Redo, StartFromTemplate, Undo
from sketchwidget.session.events import event_from_json

STROKE = [[0.123456789, 0.2], [1 / 3, 2 / 3]]
EVENTS = [
    Draw(STROKE),
    Draw(STROKE, mirror=True),
    Draw(STROKE, spacing=3),
    Erase([[0.5, 0.5]], 0.02),
    Clear(),
    Undo(),
    Redo(),
]
EVENTS += [Mode("initial"), Mode("followup"), StartFromTemplate(), Cancel()]


def test_points_are_rounded_when_the_event_is_made():
    expected = np.array([[0.12346, 0.2], [0.33333, 0.66667]], dtype=np.float32)
    np.testing.assert_array_equal(Draw(STROKE).points, expected)


def test_a_stroke_as_json():
    assert Draw(STROKE).to_json() == {
        "event": "draw",
        "points": [[0.12346, 0.2], [0.33333, 0.66667]],
        "view": "front",
        "mirror": False,
        "spacing": None,
    }


def test_strokes_of_former_files_are_as_fine_as_heads_can_be():
    former = Draw(STROKE).to_json()
    del former["spacing"]
    assert event_from_json(former) == Draw(STROKE, spacing=2)


def test_an_eraser_as_json():
    assert Erase([[0.5, 0.25]], 0.02).to_json() == {"event": "erase", "points": [[0.5, 0.25]], "radius": 0.02}


@pytest.mark.parametrize("event", EVENTS)
def test_an_event_survives_json_bit_for_bit(event):
    again = event_from_json(json.loads(json.dumps(event.to_json())))
    assert again == event
    if isinstance(event, Draw | Erase):
        assert again.points.tobytes() == event.points.tobytes()


def test_a_long_stroke_survives_json_bit_for_bit():
    angle = np.linspace(0, 60, 100_000)
    event = Draw(np.stack([0.5 + 0.3 * np.sin(angle), 0.5 + 0.3 * np.cos(1.1 * angle)], axis=1))
    assert len(event.points) == 2_000
    assert event_from_json(event.to_json()).points.tobytes() == event.points.tobytes()


def test_a_stroke_shorter_than_the_rounding_is_a_dot():
    event = Draw([[0.5, 0.5], [0.500001, 0.5]])
    assert len(event.points) == 1
    assert event_from_json(event.to_json()) == event


def test_events_that_differ_are_not_equal():
    assert all((a == b) == (i == j) for i, a in enumerate(EVENTS) for j, b in enumerate(EVENTS))
    assert Clear() != "clear"


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda: Draw([]), "a stroke"),
        (lambda: Draw([[0, np.nan]]), "a stroke"),
        (lambda: Draw([[0, 9]]), "a stroke"),
        (lambda: Draw(STROKE, view="top"), "in the view front or left or right; given 'top'"),
        (lambda: Draw(STROKE, view=None), "in the view front or left or right; given None"),
        (lambda: Draw(STROKE, mirror="yes"), "mirror is true or false; given 'yes'"),
        (lambda: Erase([[0.5, 0.5]], 0), "radius"),
        (lambda: Erase([], 0.1), "a stroke"),
        (lambda: Mode("finished"), "in the mode initial, followup, refine; given 'finished'"),
        (lambda: Mode(["initial"]), "in the mode"),
    ],
)
def test_a_bad_event_cannot_be_made(make, complaint):
    with pytest.raises(ValueError, match=complaint):
        make()


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        (None, "a JSON object"),
        ([], "a JSON object"),
        ({}, "given None"),
        ({"event": "paint"}, "one of draw, erase, .*, gesture, brush, takeover, exaggerate; given 'paint'"),
        ({"event": ["draw"]}, "one of"),
        ({"event": "undo", "times": 2}, "has the fields"),
        ({"event": "erase", "points": [[0, 0]]}, "has the fields"),
        ({"event": "erase", "points": [[0, 0]], "radius": "big"}, "radius"),
        ({"event": "erase", "points": {"x": 0}, "radius": 0.1}, "a stroke"),
        ({"event": "draw", "points": "line", "view": "front", "mirror": False}, "a stroke"),
        (Draw(STROKE).to_json() | {"spacing": 1.5}, "a whole number from 2 to 100"),
        ({"event": "draw", "points": [[0, 0]], "view": "front", "mirror": 1}, "mirror"),
    ],
)
def test_json_that_is_no_event_is_an_error_that_says_why(given, complaint):
    with pytest.raises(ValueError, match=complaint):
        event_from_json(given)
