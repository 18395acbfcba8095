"""Drawings that people made of known heads: a file of JSON lines, a header and then one drawing a line.

DeepSketch2Face collected such drawings from 20 users (section 4.1, Hand-drawn Sketches). Each person has a file of
their own, to which drawings are added one by one; `merge` makes one file of several.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..face import Face
from ..files.records import RecordFile
from ..sketch import Segment, Sketch
from ..sketch.names import UNNAMED
from ..sketch.pen import MAX_PEN_POINTS, as_pen_stroke, rounded

VIEWS = ("front", "left")

MAX_STROKES = 2_000  # of a drawing
MAX_POINTS = MAX_PEN_POINTS  # of a drawing
MAX_WEIGHTS = 1_000

Weights = tuple[np.ndarray, np.ndarray, str]


@dataclass(frozen=True, eq=False)
class Drawing:
    """A drawing of a head; drawings are equal if their JSON objects are.

    Parameters
    ----------
    strokes : sequence of (n, 4) arrays
        At least one; each kept as `as_pen_stroke` gives it. Together at most 2,000 strokes of 100,000 points.
    identity : (p,) array
    expression : (q,) array
        Weights of the head that was drawn, kept as float32.
    model : str
        `fingerprint` of the `FaceModel` whose weights they are.
    view : str
        From where the head was seen: "front", or "left" for the subject's left side.

    Raises
    ------
    ValueError
        If any of them is anything else.
    """

    strokes: tuple[np.ndarray, ...]
    identity: np.ndarray
    expression: np.ndarray
    model: str
    view: str = "front"

    def __post_init__(self) -> None:
        if not isinstance(self.strokes, Sequence) or not 1 <= len(self.strokes) <= MAX_STROKES:
            given = f"{len(self.strokes):,}" if isinstance(self.strokes, Sequence) else type(self.strokes).__name__
            raise ValueError(f"a drawing is a list of 1 to {MAX_STROKES:,} strokes; given {given}")
        strokes = tuple(as_pen_stroke(points) for points in self.strokes)
        if (total := sum(map(len, strokes))) > MAX_POINTS:
            raise ValueError(f"a drawing has at most {MAX_POINTS:,} points; given {total:,}")
        if not isinstance(self.model, str) or not re.fullmatch("[0-9a-f]{64}", self.model):
            raise ValueError(f"the fingerprint of a face model is 64 hexadecimal digits; given {self.model!r}")
        if self.view not in VIEWS:
            raise ValueError(f"a head is drawn in the view {' or '.join(VIEWS)}; given {self.view!r}")
        object.__setattr__(self, "strokes", strokes)
        for name in ("identity", "expression"):
            object.__setattr__(self, name, _as_weights(getattr(self, name), name))

    @classmethod
    def of(cls, face: Face, strokes: Sequence[Any], view: str = "front") -> Drawing:
        """The drawing of a face of a model.

        Raises
        ------
        ValueError
            If the face has no weights, or the strokes or the view are none of a drawing.
        """
        return cls(tuple(strokes), *weights_of(face), view)

    @property
    def weights(self) -> Weights:
        """Of the head: identity, expression, and the fingerprint of their model."""
        return self.identity, self.expression, self.model

    @property
    def sketch(self) -> Sketch:
        """The drawing without pressure and time, its lines unnamed."""
        return as_sketch(self.strokes)

    def to_json(self) -> dict[str, Any]:
        """The drawing as a JSON object; a stroke is a list of [x, y, pressure, milliseconds]."""
        return {
            "view": self.view,
            "model": self.model,
            # The shortest decimal numbers that read back to the same float32.
            "identity": [float(str(weight)) for weight in self.identity],
            "expression": [float(str(weight)) for weight in self.expression],
            "strokes": [rounded(points).tolist() for points in self.strokes],
        }

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Drawing) and self.to_json() == other.to_json()

    def __hash__(self) -> int:
        return hash(json.dumps(self.to_json()))


def as_sketch(strokes: Iterable[np.ndarray]) -> Sketch:
    """Strokes (n, 4) as a sketch, without pressure and time, its lines unnamed."""
    return Sketch(tuple(Segment(UNNAMED, points[:, :2]) for points in strokes))


def weights_of(face: Face) -> Weights:
    """Identity and expression of a face, and the fingerprint of their model, as drawings are kept with them.

    Raises
    ------
    ValueError
        If the face has none.
    """
    if face.identity is None or face.expression is None:
        raise ValueError("a drawing is kept with the weights of its head; this face has none")
    return face.identity, face.expression, face.model.fingerprint


_FILE = RecordFile(Drawing, "drawing")
read_drawings, write_drawings = _FILE.read, _FILE.write
append, take_back, merge = _FILE.append, _FILE.take_back, _FILE.merge


def _as_weights(given: Any, name: str) -> np.ndarray:
    expected = f"{name} weights are 1 to {MAX_WEIGHTS:,} finite numbers"
    try:
        weights = np.asarray(given)
    except (ValueError, OverflowError) as error:
        raise ValueError(expected) from error
    if weights.dtype.kind not in "iuf" or weights.ndim != 1 or not 1 <= len(weights) <= MAX_WEIGHTS:
        raise ValueError(f"{expected}; given shape {weights.shape}")
    if not (np.abs(weights) <= np.finfo(np.float32).max).all():
        raise ValueError(expected)
    weights = weights.astype(np.float32)
    weights.flags.writeable = False
    return weights
