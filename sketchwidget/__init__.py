"""sketchwidget: draw a face in a notebook, and a 3D head follows your pen.

Examples
--------
>>> import sketchwidget as sw
>>> sw.__version__
'0.1.0'
>>> len(sw.GESTURES), sw.GESTURES[:2]
(10, ('line', 'region'))
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import avatar, caricature
    from .database.database import FaceDatabase
    from .face import Face, FaceModel
    from .geometry import View
    from .gesture import GESTURES
    from .gesture.classifier import GestureClassifier
    from .inference import FaceRegressor
    from .session import Session, register_gesture
    from .sketch import Sketch, register_line
    from .widgets import DrawingCollector, GestureCollector, Studio

__version__ = "0.1.0"

# Each public name and the room that defines it: imported on first use, so that `import sketchwidget` stays light.
_HOMES = {
    "DrawingCollector": "widgets",
    "Face": "face",
    "FaceDatabase": "database.database",
    "FaceModel": "face",
    "FaceRegressor": "inference",
    "GESTURES": "gesture",
    "GestureClassifier": "gesture.classifier",
    "GestureCollector": "widgets",
    "Session": "session",
    "Sketch": "sketch",
    "Studio": "widgets",
    "View": "geometry",
    "register_gesture": "session",
    "register_line": "sketch",
}
_ROOMS = ("avatar", "caricature")  # public as a whole

__all__ = [
    "GESTURES",
    "DrawingCollector",
    "Face",
    "FaceDatabase",
    "FaceModel",
    "FaceRegressor",
    "GestureClassifier",
    "GestureCollector",
    "Session",
    "Sketch",
    "Studio",
    "View",
    "__version__",
    "avatar",
    "caricature",
    "register_gesture",
    "register_line",
]


def __getattr__(name: str) -> Any:
    if name in _ROOMS:
        return import_module(f".{name}", __name__)
    if name not in _HOMES:
        raise AttributeError(f"module 'sketchwidget' has no attribute {name!r}")
    value = getattr(import_module(f".{_HOMES[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
