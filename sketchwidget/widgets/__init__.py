"""The Studio, the collectors of drawings and gestures, and what they are made of: pad and head, half in the browser."""

from .collector import DrawingCollector
from .gesture_collector import GestureCollector
from .studio import Studio

__all__ = ["DrawingCollector", "GestureCollector", "Studio"]
