"""Gestures that people drew, told what to draw: a file of JSON lines, a header and then one gesture a line."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..files.records import RecordFile
from ..sketch.pen import as_pen_stroke, rounded
from .names import GESTURES


@dataclass(frozen=True, eq=False)
class Recording:
    """A stroke, and the gesture that it was meant to be; recordings are equal if their JSON objects are.

    Parameters
    ----------
    points : (n, 4) array
        x, y, pressure and milliseconds; kept as `as_pen_stroke` gives it.
    name : str, optional
        One of `GESTURES`; None is a stroke that is none of them.

    Raises
    ------
    ValueError
        If either is anything else.
    """

    points: np.ndarray
    name: str | None = None

    def __post_init__(self) -> None:
        if self.name is not None and self.name not in GESTURES:
            raise ValueError(f"a gesture is one of {', '.join(GESTURES)}; given {self.name!r}")
        object.__setattr__(self, "points", as_pen_stroke(self.points))

    def to_json(self) -> dict[str, Any]:
        """The recording as a JSON object."""
        return {"name": self.name, "points": rounded(self.points).tolist()}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Recording) and self.to_json() == other.to_json()

    def __hash__(self) -> int:
        return hash(json.dumps(self.to_json()))


FILE = RecordFile(Recording, "gesture")
