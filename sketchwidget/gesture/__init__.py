"""A stroke as one of ten pen gestures. Knows strokes, not faces."""

from .names import GESTURES

__all__ = ["GESTURES"]
