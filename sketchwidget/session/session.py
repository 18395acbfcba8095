"""A session as a notebook sees it: methods that act, traits to observe."""

from __future__ import annotations

import os
from time import perf_counter
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from traitlets import Any as AnyTrait
from traitlets import Bool, Dict, HasTraits, Instance, Unicode, default

from sketchwidget.geometry.view import View
from sketchwidget.sketch import Sketch, textfile

from . import file
from .apply import apply
from .events import Clear, Draw, Erase, Event, Redo, Undo
from .file import SessionFileError
from .history import History
from .layers import Layers

if TYPE_CHECKING:
    from sketchwidget.inference import FaceRegressor, Inference


class Session(HasTraits):
    """A face being drawn: every change of the sketch gives a new head.

    All traits are for reading. Those that a change touches are set together: an observer of one finds the others in
    step with it.

    Parameters
    ----------
    regressor : object with `infer(sketch) -> Inference`, optional
        Default: the shipped `FaceRegressor`, loaded when first needed.

    Attributes
    ----------
    mode : str
        "initial".
    sketch : Sketch
        The drawing, each segment with the line name inferred for it.
    face : Face
        The head of the drawing; the mean face at first.
    layers : Layers
        What the head is made of.
    frame : View
        Where the drawing places the head on the canvas.
    timings : dict of str to float
        Milliseconds of the last change: "sketch" for the edit, "inference", "total", and the steps of the inference.
    can_undo, can_redo : bool
    events : tuple of Event
        All that changed anything, undos and redos included.
    """

    mode = Unicode("initial", read_only=True)
    sketch = Instance(Sketch, args=(), read_only=True)
    face: Any = AnyTrait(read_only=True)
    layers = Instance(Layers, read_only=True)
    frame = Instance(View, args=(), read_only=True)
    timings = Dict(read_only=True)
    can_undo = Bool(False, read_only=True)
    can_redo = Bool(False, read_only=True)

    def __init__(self, regressor: FaceRegressor | None = None) -> None:
        super().__init__()
        self._regressor = regressor
        self._history = History()
        self._events: list[Event] = []

    @property
    def events(self) -> tuple[Event, ...]:
        """All events that changed anything, undos and redos included."""
        return tuple(self._events)

    def draw(self, points: Any, view: str = "front", mirror: bool = False) -> None:
        """Draw a stroke.

        Parameters
        ----------
        points : (n, 2) array-like
            Canvas points, each coordinate within [-1, 2].
        view : str
            The view it is drawn in: "front".
        mirror : bool
            Whether to draw its mirror image about the axis x = 0.5 with it.

        Raises
        ------
        ValueError
            If the points are no stroke, the view is another, or the sketch is full; nothing has changed then.
        """
        self._do(Draw(points, view, mirror))

    def preview(self, points: Any, view: str = "front", mirror: bool = False) -> Inference:
        """What `draw` would infer; nothing changes.

        For a stroke that is still being drawn. Parameters and errors are those of `draw`.
        """
        return self.regressor.infer(apply(self._history.state, Draw(points, view, mirror)).sketch)

    def erase(self, points: Any, radius: float = 0.02) -> bool:
        """Erase the ink under the eraser.

        Parameters
        ----------
        points : (n, 2) or (2,) array-like
            Where the eraser's centre went, in canvas points.
        radius : float
            In canvas units, from 0.001 to 1.

        Returns
        -------
        bool
            Whether there was any.

        Raises
        ------
        ValueError
            If the points are no stroke or the radius is out of range; nothing has changed then.
        """
        place = isinstance(points, tuple | list | np.ndarray) and len(points) == 2 and all(map(np.isscalar, points))
        path: Any = [points] if place else points
        return self._do(Erase(path, radius))

    def clear(self) -> bool:
        """Remove all ink; False if there was none."""
        return self._do(Clear())

    def undo(self) -> bool:
        """Take the last edit back; False if there was none."""
        return self._do(Undo())

    def redo(self) -> bool:
        """Do the edit last taken back again; False if there was none, or something was done since."""
        return self._do(Redo())

    def dumps(self) -> str:
        """The session as text, from which `loads` replays it."""
        return file.dumps(self._events)

    @classmethod
    def loads(cls, text: str, regressor: FaceRegressor | None = None) -> Self:
        """Replay a session from its text.

        Raises
        ------
        SessionFileError
            If the text is no session that can be replayed; the message says what is wrong, and where.
        """
        session = cls(regressor)
        started = perf_counter()
        for number, event in enumerate(file.loads(text), start=2):
            try:
                session._record(event)
            except ValueError as error:
                raise SessionFileError(f"line {number} of the session cannot be replayed: {error}") from error
        session._follow(started)
        return session

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the session to a file; a former file stays as it was if that fails."""
        textfile.write(path, self.dumps())

    @classmethod
    def load(cls, path: str | os.PathLike[str], regressor: FaceRegressor | None = None) -> Self:
        """Replay a session from its file.

        Raises
        ------
        SessionFileError
            If the file is no session that can be replayed; the message says what is wrong, and where.
        OSError
            If it cannot be read.
        """
        try:
            text = textfile.read(path)
        except ValueError as error:
            raise SessionFileError(f"{os.fspath(path)} is no session: {error}") from error
        try:
            return cls.loads(text, regressor)
        except SessionFileError as error:
            raise SessionFileError(f"{os.fspath(path)}: {error}") from error

    @default("layers")
    def _layers_of_no_drawing(self) -> Layers:
        return Layers(self.regressor.infer(Sketch()).face)

    @default("face")
    def _face_of_no_drawing(self) -> Any:
        return self.layers.head

    def _do(self, event: Event) -> bool:
        started = perf_counter()
        changed = self._record(event)
        if changed:
            self._follow(started)
        return changed

    def _record(self, event: Event) -> bool:
        changed = self._history.record(event)
        if changed:
            self._events.append(event)
        return changed

    def _follow(self, started: float) -> None:
        """Infer the head of the present state and publish both; if that fails, still publish the drawing."""
        state = self._history.state
        traits = {
            "mode": state.mode,
            "sketch": state.sketch,
            "can_undo": self._history.can_undo,
            "can_redo": self._history.can_redo,
            "timings": {"sketch": _milliseconds_since(started)},
        }
        try:
            traits |= self._inferred(state.sketch, traits["timings"])
        finally:
            traits["timings"]["total"] = _milliseconds_since(started)
            with self.hold_trait_notifications():
                for name, value in traits.items():
                    self.set_trait(name, value)

    def _inferred(self, sketch: Sketch, timings: dict[str, float]) -> dict[str, Any]:
        regressor = self.regressor
        started = perf_counter()
        inference = regressor.infer(sketch)
        layers = Layers(inference.face)
        timings = {**timings, **inference.timings, "inference": _milliseconds_since(started)}
        return {
            "sketch": sketch.renamed(inference.names),
            "face": layers.head,
            "layers": layers,
            "frame": inference.frame,
            "timings": timings,
        }

    @property
    def regressor(self) -> FaceRegressor:
        """What infers the heads; the shipped one is loaded when it is first asked for."""
        if self._regressor is None:
            # Here, so that a session imports torch with the first face only.
            from sketchwidget.inference import FaceRegressor

            self._regressor = FaceRegressor.load()
        return self._regressor


def _milliseconds_since(started: float) -> float:
    return 1e3 * (perf_counter() - started)
