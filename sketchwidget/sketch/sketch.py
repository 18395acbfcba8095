"""A drawing: named segments in the order they were drawn."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..files import textfile
from .names import COLOURS, UNNAMED, kind
from .raster import THICKNESS, paint, rasterise
from .stroke import as_points, as_stroke

MAX_STROKES = 20_000
FORMAT = "sketchwidget sketch"
VERSION = 1

_SLACK = 0.25  # strokes this far off the unit square are still taken for canvas points
_MARGIN = 0.1  # left free on each side when strokes of another frame are fitted


@dataclass(frozen=True, eq=False)
class Segment:
    """A connected piece of a line.

    Parameters
    ----------
    name : str
        The line it belongs to, one of `LINE_NAMES` or of those that `register_line` added.
    points : (n, 2) array
        Canvas points, kept as float32 and not writeable; one point is a dot.

    Raises
    ------
    ValueError
        If the name or the points are anything else.
    """

    name: str
    points: np.ndarray

    def __post_init__(self) -> None:
        kind(self.name)
        points = self.points
        checked = as_points(points)
        # Frozen float32 points cannot change any more: segments share them.
        if not (isinstance(points, np.ndarray) and points.dtype == np.float32 and not points.flags.writeable):
            points = checked.astype(np.float32)
            points.flags.writeable = False
            object.__setattr__(self, "points", points)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Segment):
            return NotImplemented
        return self.name == other.name and (
            self.points is other.points or bool(np.array_equal(self.points, other.points))
        )

    def __hash__(self) -> int:
        return hash((self.name, len(self.points)))


@dataclass(frozen=True)
class Sketch:
    """A drawing: segments in the order they were drawn, compared by value. Every change gives a new sketch.

    Parameters
    ----------
    segments : sequence of Segment
        At most 20,000.

    Raises
    ------
    ValueError
        If there are more.

    Examples
    --------
    >>> sketch = sw.Sketch.from_strokes([[[10, 10], [90, 10], [90, 90]]])  # in any frame, y down
    >>> sketch.lines.keys(), sketch.image(64).shape
    (dict_keys(['unnamed']), (64, 64))
    >>> sketch.save("corner.json")
    >>> sw.Sketch.load("corner.json") == sketch
    True
    """

    segments: tuple[Segment, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "segments", tuple(self.segments))
        if len(self.segments) > MAX_STROKES:
            raise ValueError(f"a sketch holds at most {MAX_STROKES:,} strokes; given {len(self.segments):,}")

    @classmethod
    def from_strokes(cls, strokes: Sequence[Any]) -> Sketch:
        """A sketch of freehand strokes, all of them "unnamed".

        Parameters
        ----------
        strokes : sequence of (n, 2) arrays
            In any one frame with y down. Kept as they are if they lie on the canvas (the unit square and a quarter
            around it); otherwise moved and scaled together to the middle of it, with a margin of 0.1.

        Raises
        ------
        ValueError
            If a stroke is no array (n, 2) of finite numbers, or there are too many strokes.
        TypeError
            If the strokes are no sequence.
        """
        if not isinstance(strokes, Sequence | np.ndarray) or isinstance(strokes, str):
            raise TypeError(f"a drawing is a list of strokes, each an array (n, 2); given {type(strokes).__name__}")
        drawn = [as_points(points) for points in strokes]
        if drawn:
            low, high = _bounds(drawn)
            if (low < -_SLACK).any() or (high > 1 + _SLACK).any():
                extent = (high - low).max()
                scale = (1 - 2 * _MARGIN) / extent if extent > 0 else 1.0
                drawn = [0.5 + (points - (low + high) / 2) * scale for points in drawn]
        return cls(tuple(Segment(UNNAMED, as_stroke(points)) for points in drawn))

    def __len__(self) -> int:
        return len(self.segments)

    @property
    def lines(self) -> dict[str, list[np.ndarray]]:
        """The points of the segments by line name, both in drawing order."""
        lines: dict[str, list[np.ndarray]] = {}
        for segment in self.segments:
            lines.setdefault(segment.name, []).append(segment.points)
        return lines

    def with_segment(self, name: str, points: Any) -> Sketch:
        """The sketch with one more stroke, bounded by `as_stroke`."""
        return Sketch((*self.segments, Segment(name, as_stroke(points))))

    def renamed(self, names: Sequence[str]) -> Sketch:
        """The sketch with a new name for each segment.

        Raises
        ------
        ValueError
            If there is not one name for each segment, or no line has such a name.
        """
        if len(names) != len(self):
            raise ValueError(f"a sketch of {len(self)} segments takes as many names; given {len(names)}")
        return Sketch(
            tuple(
                segment if segment.name == name else Segment(name, segment.points)
                for segment, name in zip(self.segments, names, strict=True)
            )
        )

    def image(self, size: int = 256) -> np.ndarray:
        """The sketch as a binary image (size, size), True where there is ink."""
        return rasterise([segment.points for segment in self.segments], size)

    def picture(self, size: int = 256) -> np.ndarray:
        """The sketch on white paper (size, size, 3) uint8, each line in the colour of its kind."""
        colours = [COLOURS[kind(segment.name)] for segment in self.segments]
        return paint([segment.points for segment in self.segments], colours, size)

    def svg(self) -> str:
        """The sketch as an SVG picture of the canvas, each line in the colour of its kind."""
        drawn = "".join(
            f'<polyline points="{_svg_points(segment.points)}" stroke="{COLOURS[kind(segment.name)]}"/>'
            for segment in self.segments
        )
        return (
            '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1 1" width="512" height="512"'
            ' fill="none" stroke-linecap="round" stroke-linejoin="round">'
            '<rect width="1" height="1" fill="#ffffff"/>'
            f'<g stroke-width="{THICKNESS}">{drawn}</g></svg>'
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the sketch as JSON; `load` gives back an equal one."""
        segments = [{"name": s.name, "points": _shortest_decimals(s.points)} for s in self.segments]
        document = {"format": FORMAT, "version": VERSION, "segments": segments}
        textfile.write(path, json.dumps(document, separators=(",", ":")) + "\n")

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Sketch:
        """Read a sketch that `save` wrote.

        Raises
        ------
        ValueError
            If the file is too large, no sketch, or of a newer version; the message says which, and where.
        OSError
            If it cannot be read.
        """
        try:
            return _from_document(json.loads(textfile.read(path)))
        except (ValueError, RecursionError) as error:
            raise ValueError(f"{os.fspath(path)} is no sketch that can be read: {error}") from error


def _bounds(lines: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    points = np.concatenate(lines)
    return points.min(axis=0), points.max(axis=0)


def _svg_points(points: np.ndarray) -> str:
    # A polyline of one point shows nothing; two equal points show their round caps.
    shown = points if len(points) > 1 else np.repeat(points, 2, axis=0)
    return " ".join(f"{x:.5g},{y:.5g}" for x, y in shown.tolist())


def _shortest_decimals(points: np.ndarray) -> list[list[float]]:
    """The shortest decimal numbers that read back to the same float32, by way of NumPy's printing."""
    return points.astype("U").astype(np.float64).tolist()


def _from_document(document: Any) -> Sketch:
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise ValueError(f'its "format" is not "{FORMAT}"')
    version = document.get("version")
    if version != VERSION:
        raise ValueError(f"its version is {version!r}, and this sketchwidget reads version {VERSION}")
    given = document.get("segments")
    if not isinstance(given, list):
        raise ValueError('its "segments" are no list')
    segments = []
    for i, item in enumerate(given):
        if not isinstance(item, dict) or item.keys() != {"name", "points"}:
            raise ValueError(f'segment {i} is not an object of "name" and "points"')
        try:
            segments.append(Segment(**item))
        except ValueError as error:
            raise ValueError(f"segment {i}: {error}") from error
    return Sketch(tuple(segments))
