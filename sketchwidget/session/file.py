"""Sessions as text: JSON lines, a header and then one event a line."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, NamedTuple

from .events import Event, event_from_json

FORMAT = "sketchwidget session"
VERSION = 1


class SessionFileError(ValueError):
    """A session that cannot be read; the message says what is wrong, and where."""


class Recorded(NamedTuple):
    """What the text of a session holds: its events, and whether its drawings were inferred."""

    events: list[Event]
    inference: bool


def dumps(events: Sequence[Event], inference: bool = True) -> str:
    """The text of a session with these events, whose drawings are inferred or not."""
    return joined([line(event) for event in events], inference)


def line(event: Event) -> str:
    """The line of an event."""
    return _compact(event.to_json())


def joined(lines: Sequence[str], inference: bool = True) -> str:
    """The text of a session with these lines."""
    header = {"format": FORMAT, "version": VERSION, "events": len(lines), "inference": inference}
    return "".join([_compact(header), *lines])


def loads(text: str) -> Recorded:
    """What a session's text holds; one that does not say so was inferred.

    Raises
    ------
    SessionFileError
        If the text is no session, cut short, of a newer version, or has a line that is no event.
    """
    header, *lines = text.removesuffix("\n").split("\n")
    count, inference = _announced(_parsed(header, 1))
    if len(lines) != count:
        raise SessionFileError(
            f"the session has {len(lines)} events where its first line announces {count}: cut short?"
        )
    return Recorded([_event(line, number) for number, line in enumerate(lines, start=2)], inference)


def _compact(value: dict[str, Any]) -> str:
    return json.dumps(value, separators=(",", ":")) + "\n"


def _event(line: str, number: int) -> Event:
    given = _parsed(line, number)
    try:
        return event_from_json(given)
    except (OverflowError, ValueError) as error:
        raise SessionFileError(f"line {number} of the session is no event: {error}") from error


def _parsed(line: str, number: int) -> Any:
    try:
        return json.loads(line)
    except (ValueError, RecursionError) as error:
        raise SessionFileError(f"line {number} of the session is no JSON, or cut short: {error}") from error


def _announced(header: Any) -> tuple[int, bool]:
    """How many events a session has, and whether it infers."""
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise SessionFileError(f'this is no session: its first line has no "format": "{FORMAT}"')
    version, count, inference = header.get("version"), header.get("events"), header.get("inference", True)
    if type(version) is not int or version < 1:
        raise SessionFileError(f"the version of the session is a positive number; given {version!r}")
    if version > VERSION:
        raise SessionFileError(f"the session is of version {version}; this sketchwidget reads up to version {VERSION}")
    if type(count) is not int or count < 0:
        raise SessionFileError(f'the "events" of the session\'s first line are a number; given {count!r}')
    if type(inference) is not bool:
        raise SessionFileError(f'the "inference" of the session\'s first line is true or false; given {inference!r}')
    return count, inference
