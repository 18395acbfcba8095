"""Drawings that people made of known heads: a file of JSON lines, a header and then one drawing a line.

DeepSketch2Face collected such drawings from 20 users (section 4.1, Hand-drawn Sketches). Each person has a file of
their own, to which drawings are added one by one; `merge` makes one file of several.
"""

from __future__ import annotations

import json
import os
import re
import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from itertools import chain
from pathlib import Path
from typing import IO, Any

import numpy as np

from ..face import Face
from ..sketch import Segment, Sketch
from ..sketch.names import UNNAMED
from ..sketch.stroke import REACH

FORMAT = "sketchwidget drawings"
VERSION = 1
VIEWS = ("front", "left")

MAX_BYTES = 512 * 2**20  # of a file
MAX_LINE = 8 * 2**20  # bytes: more than a drawing of `MAX_POINTS` has
MAX_STROKES = 2_000  # of a drawing
MAX_POINTS = 100_000  # of a drawing: eight minutes of ink from a tablet of 200 Hz
MAX_MILLISECONDS = 1_000_000.0  # of a stroke; up to here float32 tells tenths apart
MAX_WEIGHTS = 1_000

_PER_UNIT = np.array([1e5, 1e5, 1e3, 10.0])  # steps in which x, y, pressure and time are kept


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
            raise ValueError(f"a drawing is a list of 1 to {MAX_STROKES:,} strokes")
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
            "strokes": [_rounded(points).tolist() for points in self.strokes],
        }

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Drawing) and self.to_json() == other.to_json()

    def __hash__(self) -> int:
        return hash(_line(self))


def as_pen_stroke(points: Any) -> np.ndarray:
    """What a pen wrote, as a stroke with pressure and time.

    Parameters
    ----------
    points : (n, 4) array-like
        x and y in canvas units, within [-1, 2]; pressure 0..1; milliseconds since the stroke began, which never
        decrease.

    Returns
    -------
    (n, 4) float32 array
        Not writeable; rounded as it is written to files: to 1e-5, 1e-5, 1e-3 and 0.1.

    Raises
    ------
    ValueError
        If the points are anything else.
    """
    try:
        array = np.asarray(points)
    except (ValueError, OverflowError):  # rows of different lengths; whole numbers beyond any float
        array = np.empty((0, 4))
    if array.dtype.kind not in "iuf" or array.ndim != 2 or array.shape[1] != 4 or not 1 <= len(array) <= MAX_POINTS:
        raise ValueError(
            f"a stroke is 1 to {MAX_POINTS:,} points, each of four numbers: x, y, pressure and milliseconds"
        )
    x, y, pressure, time = array.T
    low, high = REACH
    # Comparisons with NaN are false.
    if not ((x >= low) & (x <= high) & (y >= low) & (y <= high)).all():
        raise ValueError(f"a stroke lies within [{low:g}, {high:g}] of the canvas, the unit square")
    if not ((pressure >= 0) & (pressure <= 1)).all():
        raise ValueError("the pressure of a pen is between 0 and 1")
    if not ((time >= 0).all() and (np.diff(time) >= 0).all() and (time <= MAX_MILLISECONDS).all()):
        raise ValueError(f"the times of a stroke are 0 to {MAX_MILLISECONDS:,.0f} ms and never decrease")
    stroke = _rounded(array).astype(np.float32)
    stroke.flags.writeable = False
    return stroke


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


def read_drawings(path: str | os.PathLike[str]) -> list[Drawing]:
    """The drawings of a file, in the order they were added.

    A last line that was cut short, as when a kernel dies while it writes, is left out with a warning.

    Raises
    ------
    ValueError
        If the file is larger than 512 MB, holds no drawings, is of a newer version, or has a line that is no drawing;
        the message names the file and the line.
    OSError
        If it cannot be read.
    """
    with open(path, "rb") as file:
        return list(_read(file, os.fspath(path)))


def write_drawings(path: str | os.PathLike[str], drawings: Iterable[Drawing]) -> None:
    """Write a file of drawings in one step: a crash or a full disk leaves a former one as it was.

    Raises
    ------
    ValueError
        If it would be larger than `read_drawings` accepts.
    OSError
        If it cannot be written.
    """
    path = Path(path)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with open(unfinished, "wb") as file:
            for line in chain([_HEADER], map(_line, drawings)):
                file.write(line)
                _require_room(path, file.tell())
            file.flush()
            os.fsync(file.fileno())
        os.replace(unfinished, path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise


def append(path: str | os.PathLike[str], drawing: Drawing) -> None:
    """Add a drawing to a file, a new one if there is none; it is on the disk when this returns.

    A last line that was cut short goes, with a warning.

    Raises
    ------
    ValueError
        If the file holds no drawings, or would be larger than `read_drawings` accepts.
    OSError
        If it cannot be written.
    """
    if not Path(path).exists():
        write_drawings(path, [drawing])
        return
    line = _line(drawing)
    with open(path, "r+b") as file:
        _check_header(file.readline(MAX_LINE), os.fspath(path))
        size = _mended(file, os.fspath(path))
        _require_room(path, size + len(line))
        file.seek(size)
        file.write(line)
        file.flush()
        os.fsync(file.fileno())


def take_back(path: str | os.PathLike[str], drawing: Drawing) -> None:
    """Remove a drawing that was the last to be added.

    Raises
    ------
    ValueError
        If the last line of the file is not this drawing; the file is as before.
    OSError
        If it cannot be written.
    """
    line = _line(drawing)
    with open(path, "r+b") as file:
        size = file.seek(0, os.SEEK_END) - len(line)
        file.seek(max(0, size))
        if size < len(_HEADER) or file.read() != line:
            raise ValueError(f"the last line of {os.fspath(path)} is another drawing")
        file.truncate(size)


def merge(paths: Iterable[str | os.PathLike[str]], out: str | os.PathLike[str]) -> tuple[int, int]:
    """Write the drawings of several files into one, in order, each of those that are equal once.

    Parameters
    ----------
    paths : iterable of paths
    out : path
        A new file, or one of `paths`: others are not overwritten.

    Returns
    -------
    kept, dropped : int
        Numbers of drawings.

    Raises
    ------
    ValueError, OSError
        As `read_drawings` and `write_drawings` do; no file has changed then.
    FileExistsError
        If there is such a file and it is none of those to be merged.
    """
    paths, out = [Path(path) for path in paths], Path(out)
    if out.exists() and not any(path.exists() and path.samefile(out) for path in paths):
        raise FileExistsError(f"{out} exists, and is none of the files to be merged: name a new file")
    drawings = [drawing for path in paths for drawing in read_drawings(path)]
    once = dict.fromkeys(drawings)
    write_drawings(out, once)
    return len(once), len(drawings) - len(once)


def _line(drawing: Drawing) -> bytes:
    return _as_line(drawing.to_json())


def _as_line(content: dict[str, Any]) -> bytes:
    return json.dumps(content, separators=(",", ":")).encode() + b"\n"


_HEADER = _as_line({"format": FORMAT, "version": VERSION})


def _read(file: IO[bytes], name: str) -> Iterator[Drawing]:
    if os.fstat(file.fileno()).st_size > MAX_BYTES:
        raise ValueError(f"{name} is larger than the {MAX_BYTES >> 20} MB that a file of drawings may have")
    _check_header(file.readline(MAX_LINE), name)
    number = 1
    while line := file.readline(MAX_LINE + 1):
        number += 1
        if len(line) > MAX_LINE:
            raise ValueError(f"{name}, line {number} is longer than the {MAX_LINE >> 20} MB of a drawing")
        if _is_cut_short(line):
            _warn_of_cut(name)
        else:
            yield _drawing(line, f"{name}, line {number}")


def _check_header(line: bytes, name: str) -> None:
    try:
        header = json.loads(line)
    except (ValueError, RecursionError):
        header = None
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise ValueError(f'{name} holds no drawings: its first line has no "format": "{FORMAT}"')
    if (version := header.get("version")) != VERSION:
        raise ValueError(f"{name} is of version {version!r}; this sketchwidget reads version {VERSION}")


def _drawing(line: bytes, where: str) -> Drawing:
    try:
        given = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{where} is no JSON: {error}") from error
    expected = [field.name for field in fields(Drawing)]
    if not isinstance(given, dict) or given.keys() != set(expected):
        raise ValueError(f"{where} is no drawing: it is an object of {', '.join(expected)}")
    try:
        return Drawing(**given)
    except ValueError as error:
        raise ValueError(f"{where} is no drawing: {error}") from error


def _is_cut_short(line: bytes) -> bool:
    """Whether a line without its end is no JSON; an editor may have taken the end from a whole one."""
    if line.endswith(b"\n"):
        return False
    try:
        json.loads(line)
    except (ValueError, RecursionError):
        return True
    return False


def _mended(file: IO[bytes], name: str) -> int:
    """The size of a file of which every line has its end: one that lacks it gets it, or goes if it was cut short."""
    size = file.seek(0, os.SEEK_END)
    tail = min(size, MAX_LINE)
    file.seek(size - tail)
    last = file.read(tail).rpartition(b"\n")[2]
    if not last:
        return size
    if _is_cut_short(last):
        _warn_of_cut(name)
        return file.truncate(size - len(last))
    file.write(b"\n")
    return size + 1


def _warn_of_cut(name: str) -> None:
    warnings.warn(f"the last drawing in {name} was cut short and is left out", stacklevel=4)


def _require_room(path: str | os.PathLike[str], size: int) -> None:
    if size > MAX_BYTES:
        raise ValueError(f"{os.fspath(path)} would be larger than the {MAX_BYTES >> 20} MB that can be read back")


def _rounded(points: np.ndarray) -> np.ndarray:
    return np.round(points.astype(np.float64) * _PER_UNIT) / _PER_UNIT


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
