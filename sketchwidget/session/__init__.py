"""The state machine behind a drawing: events in, a new state out. Runs in a plain script, without any widget."""

from .apply import apply
from .events import Cancel, Clear, Draw, Erase, Event, Mode, Redo, StartFromTemplate, Undo
from .file import SessionFileError
from .history import History
from .layers import Displacement, Layers
from .modeller import Modelled, Modeller
from .session import Session
from .state import State

__all__ = [
    "Cancel",
    "Clear",
    "Displacement",
    "Draw",
    "Erase",
    "Event",
    "History",
    "Layers",
    "Mode",
    "Modelled",
    "Modeller",
    "Redo",
    "Session",
    "SessionFileError",
    "StartFromTemplate",
    "State",
    "Undo",
    "apply",
]
