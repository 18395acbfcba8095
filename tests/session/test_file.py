import json

import pytest

from sketchwidget.session import Clear, Draw, Erase, SessionFileError, Undo
from sketchwidget.session.file import dumps, loads

EVENTS = [Draw([[0.1, 0.2], [0.3, 0.4]]), Erase([[0.2, 0.3]], 0.02), Undo(), Clear()]
HEADER = {"format": "sketchwidget session", "version": 1, "events": 0}


def test_a_session_is_a_header_and_an_event_a_line():
    header, *lines = dumps(EVENTS).splitlines()
    assert json.loads(header) == {"format": "sketchwidget session", "version": 1, "events": 4, "inference": True}
    assert [json.loads(line)["event"] for line in lines] == ["draw", "erase", "undo", "clear"]


def test_what_is_written_is_read():
    assert loads(dumps(EVENTS)) == (EVENTS, True)
    assert loads(dumps([], inference=False)) == ([], False)


def test_lines_may_end_as_on_windows():
    assert loads(dumps(EVENTS).replace("\n", "\r\n")).events == EVENTS


def test_a_file_that_does_not_say_so_was_inferred():
    assert loads(dumps(EVENTS).replace(',"inference":true', "", 1)) == (EVENTS, True)


def test_a_session_cut_short_anywhere_is_an_error():
    text = dumps(EVENTS)
    for size in range(len(text) - 1):
        with pytest.raises(SessionFileError, match=r"cut short|no JSON"):
            loads(text[:size])


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "line 1 of the session is no JSON"),
        ("\x00\x01", "line 1"),
        ("[" * 100_000, "line 1"),
        ("[]", "this is no session"),
        ('"sketchwidget session"', "this is no session"),
        (json.dumps({**HEADER, "format": "sketchwidget sketch"}), "this is no session"),
        (json.dumps({**HEADER, "version": 2}), "of version 2; this sketchwidget reads up to version 1"),
        (json.dumps({**HEADER, "version": "1"}), "positive number; given '1'"),
        (json.dumps({**HEADER, "version": True}), "positive number; given True"),
        (json.dumps({**HEADER, "version": 0}), "positive number; given 0"),
        (json.dumps({**HEADER, "events": None}), "given None"),
        (json.dumps({**HEADER, "events": -1}), "given -1"),
        (json.dumps({**HEADER, "events": 2.0}), "given 2.0"),
        (json.dumps({**HEADER, "events": 1}), "0 events where its first line announces 1"),
        (json.dumps(HEADER) + '\n{"event":"undo"}', "1 events where its first line announces 0"),
        (json.dumps({**HEADER, "events": 1}) + '\n{"event":"paint"}', "line 2 of the session is no event"),
        (json.dumps({**HEADER, "events": 1}) + "\n\n", "line 2 of the session is no JSON"),
        (
            json.dumps({**HEADER, "events": 2})
            + '\n{"event":"undo"}\n{"event":"draw","points":[[0,NaN]],"view":"front","mirror":false}',
            "line 3 of the session is no event: a stroke",
        ),
    ],
)
def test_a_text_that_is_no_session_is_an_error_that_says_where(text, complaint):
    with pytest.raises(SessionFileError, match=complaint):
        loads(text)
