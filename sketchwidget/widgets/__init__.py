"""The Studio, the collector of drawings, and the widgets they are made of: pad and head, each half in the browser."""

from .collector import DrawingCollector
from .studio import Studio

__all__ = ["DrawingCollector", "Studio"]
