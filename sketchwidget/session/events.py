"""What a user can do, as values: each event is a small frozen object and a JSON object."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from sketchwidget.face.texture import Texture
from sketchwidget.geometry.view import View
from sketchwidget.sketch import as_stroke
from sketchwidget.sketch.erase import as_radius
from sketchwidget.sketch.fairing import FINEST
from sketchwidget.sketch.stroke import MAX_GIVEN_POINTS

from .packed import pack, pack_texture, rounded, unpack, unpack_texture

VIEWS = ("front", "left", "right")
FEWEST_POINTS = 3  # of a gesture: a stroke of two is a slip of the pen
MODES = ("initial", "followup", "refine")

SCALES = (1e-4, 0.2)  # canvas units per mm: of a head 5 mm high to one 10 m high where the pad is a span of the hand
_DECIMALS = 5  # of a coordinate: 2.5 micrometres of the head
_VIEW_DECIMALS = 6  # float32 has no more
_AMOUNT_DECIMALS = 3


@dataclass(frozen=True, eq=False)
class Event:
    """One event; events are equal if their JSON objects are."""

    def to_json(self) -> dict[str, Any]:
        """The event as a JSON object: its kind under "event", then its fields."""
        values = {field.name: _plain(getattr(self, field.name)) for field in fields(self)}
        return {"event": type(self).__name__.lower(), **values}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Event) and self.to_json() == other.to_json()

    def __hash__(self) -> int:
        return hash(json.dumps(self.to_json()))


@dataclass(frozen=True, eq=False)
class Draw(Event):
    """A stroke of the pen.

    Parameters
    ----------
    points : (n, 2) array-like
        Canvas points, kept as float32 rounded to 1e-5 as they are written: a session read back is equal bit for bit.
    view : str
        The view it is drawn in: "front", or "left" or "right" for the profile.
    mirror : bool
        Whether its mirror image is drawn with it: about the axis x = 0.5, in follow-up sketching about the middle of
        the head.
    spacing : int, optional
        How smooth a line of a head it becomes, once that was found: handle points from knot to knot, at least 2.

    Raises
    ------
    ValueError
        If the points are no stroke, or the view, `mirror` or `spacing` are anything else.
    """

    points: np.ndarray
    view: str = "front"
    mirror: bool = False
    spacing: int | None = None

    def __post_init__(self) -> None:
        if self.view not in VIEWS:
            raise ValueError(f"a stroke is drawn in the view {' or '.join(VIEWS)}; given {self.view!r}")
        if not isinstance(self.mirror, bool):
            raise ValueError(f"mirror is true or false; given {self.mirror!r}")
        if self.spacing is not None and (type(self.spacing) is not int or not 2 <= self.spacing <= 100):
            raise ValueError(f"spacing is a whole number from 2 to 100, or none; given {self.spacing!r}")
        object.__setattr__(self, "points", _rounded(self.points))


@dataclass(frozen=True, eq=False)
class Erase(Event):
    """A pass of the eraser.

    Parameters
    ----------
    points : (n, 2) array-like
        Where its centre went, in canvas points, rounded as those of `Draw`.
    radius : float
        In canvas units, from 0.001 to 1.

    Raises
    ------
    ValueError
        If the points are no stroke or the radius is out of range.
    """

    points: np.ndarray
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", _rounded(self.points))
        object.__setattr__(self, "radius", as_radius(self.radius))


@dataclass(frozen=True, eq=False)
class Clear(Event):
    """All ink goes."""


@dataclass(frozen=True, eq=False)
class Undo(Event):
    """The last edit that counts is taken back."""


@dataclass(frozen=True, eq=False)
class Redo(Event):
    """The last edit taken back counts again."""


@dataclass(frozen=True, eq=False)
class Mode(Event):
    """A change of the mode of interaction.

    Parameters
    ----------
    mode : str
        "initial", "followup" or "refine" (the paper's sections 3.1 to 3.3).

    Raises
    ------
    ValueError
        If the mode is another.
    """

    mode: str

    def __post_init__(self) -> None:
        if not isinstance(self.mode, str) or self.mode not in MODES:
            raise ValueError(f"a session is in the mode {', '.join(MODES)}; given {self.mode!r}")


@dataclass(frozen=True, eq=False)
class StartFromTemplate(Event):
    """Follow-up sketching begins with the lines of the template in place of the drawing."""


@dataclass(frozen=True, eq=False)
class Cancel(Event):
    """What was erased and waits to be drawn anew is as it was."""


@dataclass(frozen=True, eq=False)
class Gesture(Event):
    """A stroke of the pen on the head.

    Parameters
    ----------
    points : (n, 2) array-like
        At least three canvas points, rounded as those of `Draw`.
    view : View or str, optional
        How the head is seen: a view, kept rounded as it is written, or the name of a preset in the frame of the
        drawing; None is the front.
    tool : str, optional
        What the stroke does if it is to be no gesture: the name of a tool that a user registered.
    name : str, optional
        What gesture the stroke is, once it was recognised; the tool's name for a tool.

    Raises
    ------
    ValueError
        If fewer than three points differ from the one before them, the points are no stroke, or the view is none.
    """

    points: np.ndarray
    view: View | str | None = None
    tool: str | None = None
    name: str | None = None

    def __post_init__(self) -> None:
        points = _rounded(self.points)
        places = 1 + int((points[1:] != points[:-1]).any(axis=1).sum())
        if places < FEWEST_POINTS:
            raise ValueError(f"a gesture has at least {FEWEST_POINTS} points; given {places} different ones")
        for name in (self.tool, self.name):
            if name is not None and not isinstance(name, str):
                raise ValueError(f"a gesture or a tool is given by its name; given {name!r}")
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "view", _as_view(self.view))

    def view_in(self, frame: View) -> View:
        """How the head is seen, where a drawing has it in `frame`."""
        return as_seen(self.view, frame)


@dataclass(frozen=True, eq=False)
class Brush(Event):
    """Vertices of the head are marked as handles, or unmarked.

    Parameters
    ----------
    vertices : (k,) array-like of int
        At most a million numbers of vertices, kept once each, in order.
    erase : bool
        Whether they are unmarked.

    Raises
    ------
    ValueError
        If they are anything else.
    """

    vertices: np.ndarray
    erase: bool = False

    def __post_init__(self) -> None:
        expected = f"vertices are given by up to {MAX_GIVEN_POINTS:,} whole numbers"
        try:
            vertices = np.asarray(self.vertices)
        except ValueError as error:
            raise ValueError(f"{expected}; given lists of different lengths") from error
        whole = vertices.dtype.kind in "iu" or not vertices.size
        if not whole or vertices.ndim != 1 or len(vertices) > MAX_GIVEN_POINTS:
            raise ValueError(f"{expected}; given {vertices.dtype} values of shape {vertices.shape}")
        if vertices.size and not 0 <= vertices.min() <= vertices.max() <= np.iinfo(np.int32).max:
            raise ValueError(f"{expected}, none negative; given {vertices.min()} to {vertices.max()}")
        if not isinstance(self.erase, bool):
            raise ValueError(f"erase is true or false; given {self.erase!r}")
        vertices = np.unique(vertices.astype(np.int32))
        vertices.flags.writeable = False
        object.__setattr__(self, "vertices", vertices)


@dataclass(frozen=True, eq=False)
class TakeOver(Event):
    """A head from elsewhere becomes the session's: of a caricature, a portrait, or another session.

    Parameters
    ----------
    vertices : (V, 3) array-like, or str
        Millimetres, in the topology of the session's model, kept as float32 rounded to 0.01; or as they are written to
        a file, packed in text.
    texture : Texture, or dict of str, optional
        What lies on it; or as it is written to a file.

    Raises
    ------
    ValueError
        If they are no vertices of a head, or the texture is none for as many.
    """

    vertices: Any
    texture: Any = None

    def __post_init__(self) -> None:
        packed = isinstance(self.vertices, str)
        vertices = unpack(self.vertices) if packed else rounded(self.vertices)
        known = self.texture is None or isinstance(self.texture, Texture)
        texture = self.texture if known else unpack_texture(self.texture)
        if texture is not None and len(texture.uv) != len(vertices):
            raise ValueError(f"the texture is for {len(texture.uv)} vertices; the head has {len(vertices)}")
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "texture", texture)

    def to_json(self) -> dict[str, Any]:
        """The event as a JSON object; vertices and texture are packed."""
        return {"event": "takeover", "vertices": pack(self.vertices), "texture": pack_texture(self.texture)}


@dataclass(frozen=True, eq=False)
class Exaggerate(Event):
    """The head differs from the mean face more, or less.

    Parameters
    ----------
    amount : float
        From 0, the mean face, by 1, as it is, to 3. Right after another one it takes that one's place.

    Raises
    ------
    ValueError
        If it is anything else.
    """

    amount: float

    def __post_init__(self) -> None:
        from sketchwidget.caricature.exaggeration import as_amount

        object.__setattr__(self, "amount", round(as_amount(self.amount), _AMOUNT_DECIMALS))


_EVENTS = (Draw, Erase, Clear, Undo, Redo, Mode, StartFromTemplate, Cancel, Gesture, Brush, TakeOver, Exaggerate)
_KINDS = {event.__name__.lower(): event for event in _EVENTS}

# Fields that files of former versions lack, and what they mean by that: lines were as fine as they are drawn.
_LATER = {"draw": {"spacing": FINEST}, "gesture": {"name": None}, "takeover": {"texture": None}}


def event_from_json(given: Any) -> Event:
    """The event of a JSON object.

    Raises
    ------
    ValueError
        If the object is no event; the message says why.
    """
    if not isinstance(given, dict):
        raise ValueError("an event is a JSON object")
    values = dict(given)
    kind = values.pop("event", None)
    if not isinstance(kind, str) or kind not in _KINDS:
        raise ValueError(f'the "event" is one of {", ".join(_KINDS)}; given {kind!r}')
    expected = {field.name for field in fields(_KINDS[kind])}
    complete = _LATER.get(kind, {}) | values
    if complete.keys() != expected:
        raise ValueError(f"the event {kind!r} has the fields {sorted(expected)}; given {sorted(values)}")
    return _KINDS[kind](**complete)


def _plain(value: Any) -> Any:
    """A field's value as JSON has it. Points leave float32 for the decimal number they were rounded to."""
    if isinstance(value, View):
        return {"rotation": _decimal(value.rotation), "scale": value.scale, "centre": _decimal(value.centre)}
    if isinstance(value, np.ndarray):
        return value.tolist() if value.dtype.kind == "i" else np.round(value.astype(np.float64), _DECIMALS).tolist()
    return value


def _decimal(values: np.ndarray) -> Any:
    return np.round(values.astype(np.float64), _VIEW_DECIMALS).tolist()


def as_seen(view: View | str | None, frame: View) -> View:
    """A view as `Gesture` has it: itself, or a preset in the frame of a drawing.

    Raises
    ------
    ValueError
        If it is none.
    """
    view = _as_view(view)
    return view if isinstance(view, View) else View(View.preset(view or "front").rotation, frame.scale, frame.centre)


def _as_view(given: Any) -> View | str | None:
    if given is None:
        return None
    if isinstance(given, str):
        View.preset(given)  # or an error
        return given
    if isinstance(given, dict) and given.keys() == {"rotation", "scale", "centre"}:
        try:
            given = View(**given)
        except TypeError as error:
            raise ValueError(f"a view has a rotation, a scale and a centre of numbers; given {given!r}") from error
    if not isinstance(given, View):
        raise ValueError(f"a view is a View, the name of a preset or None; given {given!r}")
    if not SCALES[0] <= given.scale <= SCALES[1]:
        raise ValueError(
            f"a head is refined at a scale from {SCALES[0]} to {SCALES[1]} canvas units per mm; given {given.scale:g}"
        )
    return View(_decimal(given.rotation), float(f"{given.scale:.9g}"), _decimal(given.centre))


def _rounded(points: Any) -> np.ndarray:
    # Bounded before and after: resampling leaves more decimals, and rounding can make a short stroke a dot.
    return as_stroke(np.round(as_stroke(points).astype(np.float64), _DECIMALS))
