"""The state machine behind a drawing: events in, a new state out. Runs in a plain script, without any widget."""

from .apply import apply
from .behaviours import register_gesture
from .events import (
    Brush,
    Cancel,
    Clear,
    Draw,
    Erase,
    Event,
    Exaggerate,
    Gesture,
    Mode,
    Redo,
    StartFromTemplate,
    TakeOver,
    Undo,
)
from .file import SessionFileError
from .history import History
from .layers import Displacement, Layers
from .modeller import Modelled, Modeller
from .refinement import Edit, Refinement
from .session import Session
from .state import State

__all__ = [
    "Brush",
    "Cancel",
    "Clear",
    "Displacement",
    "Draw",
    "Edit",
    "Erase",
    "Event",
    "Exaggerate",
    "Gesture",
    "History",
    "Layers",
    "Mode",
    "Modelled",
    "Modeller",
    "Redo",
    "Refinement",
    "Session",
    "SessionFileError",
    "StartFromTemplate",
    "State",
    "TakeOver",
    "Undo",
    "apply",
    "register_gesture",
]
