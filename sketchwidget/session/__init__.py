"""The state machine behind a drawing: events in, a new state out. Runs in a plain script, without any widget."""

from .apply import apply
from .events import Clear, Draw, Erase, Event, Redo, Undo
from .file import SessionFileError
from .history import History
from .session import Session
from .state import State

__all__ = [
    "Clear",
    "Draw",
    "Erase",
    "Event",
    "History",
    "Redo",
    "Session",
    "SessionFileError",
    "State",
    "Undo",
    "apply",
]
