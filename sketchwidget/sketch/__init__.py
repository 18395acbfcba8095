"""Strokes and drawings in 2D: lines and segments, resampling, erasing, rasterising."""

from .erase import erase
from .names import COLOURS, FEATURES, LINE_NAMES, SILHOUETTE, UNNAMED, WRINKLE, kind, register_line
from .piece import Piece
from .polyline import arc_length, lengths, resample, resample_each
from .raster import rasterise
from .sketch import Segment, Sketch
from .stroke import as_stroke

__all__ = [
    "COLOURS",
    "FEATURES",
    "LINE_NAMES",
    "SILHOUETTE",
    "UNNAMED",
    "WRINKLE",
    "Piece",
    "Segment",
    "Sketch",
    "arc_length",
    "as_stroke",
    "erase",
    "kind",
    "lengths",
    "rasterise",
    "register_line",
    "resample",
    "resample_each",
]
