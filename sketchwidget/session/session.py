"""A session as a notebook sees it: methods that act, traits to observe."""

from __future__ import annotations

import os
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from traitlets import Any as AnyTrait
from traitlets import Bool, Dict, Float, HasTraits, Instance, Unicode, default

from sketchwidget.files import textfile
from sketchwidget.geometry.enclosure import brushed
from sketchwidget.geometry.view import View
from sketchwidget.gesture.names import ARROWS
from sketchwidget.sketch import Sketch, as_stroke
from sketchwidget.sketch.erase import as_radius
from sketchwidget.sketch.gap import carried_on
from sketchwidget.threads import one_thread

from . import file, profile
from .apply import apply
from .autosave import Autosave
from .events import (
    Brush,
    Cancel,
    Clear,
    Draw,
    Erase,
    Event,
    Exaggerate,
    Gesture,
    Mode,
    Redo,
    StartFromTemplate,
    TakeOver,
    Undo,
    as_seen,
)
from .file import SessionFileError
from .history import History
from .layers import Layers
from .modeller import Modelled, Modeller
from .naming import may_change, named
from .obeying import obeyed
from .refinement import Refinement
from .state import State

if TYPE_CHECKING:
    from sketchwidget.face import Face
    from sketchwidget.face.texture import Texture
    from sketchwidget.inference import FaceRegressor


class _ModeTrait(Unicode):
    """A trait whose assignment is an event: it changes when the mode has been entered."""

    def __set__(self, session: Session, mode: str) -> None:
        session.do(Mode(mode))


class Session(HasTraits):
    """A face being drawn: every change of the sketch gives a new head.

    All traits but the mode are for reading. Those that a change touches are set together: an observer of one finds the
    others in step with it.

    Parameters
    ----------
    regressor : object with `infer(sketch) -> Inference`, optional
        Default: the shipped `FaceRegressor`, loaded when first needed.
    inference : bool
        If False, no sketch is inferred: the session begins with the lines of the template, and only they deform it (the
        deformation-only interface of the paper's 6.1).

    Attributes
    ----------
    mode : str
        "initial", "followup" or "refine"; assigning another enters it, which can be undone like any edit.
    sketch : Sketch
        The drawing, each segment with the line name inferred for it.
    face : Face
        The head of the drawing; the mean face at first.
    texture : Texture or None
        What lies on the head, if it was taken over with one.
    layers : Layers
        What the head is made of.
    frame : View
        Where the drawing places the head on the canvas.
    refinement : Refinement
        What is marked on the head, and what gestures made of it; see also `handles` and `region`.
    exaggeration : float
        How much the head was exaggerated, 1 for as it is; what is done after it starts from 1 again.
    timings : dict of str to float
        Milliseconds of the last change: "sketch" for the edit, "inference", "total", and the steps of the inference.
    gap : Gap or None
        The part of a line that was erased in follow-up sketching and must be drawn next.
    can_undo, can_redo : bool
    events : tuple of Event
        All that changed anything, undos and redos included.

    Examples
    --------
    >>> turn = np.linspace(0, 2 * np.pi, 60)
    >>> session = sw.Session()
    >>> session.draw(np.stack([0.5 + 0.27 * np.sin(turn), 0.5 - 0.38 * np.cos(turn)], axis=1))
    >>> session.draw([[0.33, 0.41], [0.39, 0.385], [0.46, 0.40]], mirror=True)
    >>> sorted(session.sketch.lines)
    ['left_brow', 'right_brow', 'silhouette']
    >>> session.save("drawing.jsonl")
    >>> bool(np.array_equal(sw.Session.load("drawing.jsonl").face.vertices, session.face.vertices))
    True
    """

    mode = _ModeTrait("initial")
    sketch = Instance(Sketch, args=(), read_only=True)
    face: Any = AnyTrait(read_only=True)
    texture: Any = AnyTrait(None, read_only=True)
    layers = Instance(Layers, read_only=True)
    frame = Instance(View, args=(), read_only=True)
    refinement = Instance(Refinement, args=(), read_only=True)
    exaggeration = Float(1.0, read_only=True)
    timings = Dict(read_only=True)
    gap: Any = AnyTrait(None, read_only=True)
    can_undo = Bool(False, read_only=True)
    can_redo = Bool(False, read_only=True)

    def __init__(self, regressor: FaceRegressor | None = None, inference: bool = True) -> None:
        super().__init__()
        self._modeller = Modeller(regressor, inference)
        self._history = History(self._modeller)
        self._events: list[Event] = []
        self._autosave: Autosave | None = None
        if not inference:
            self.start_from_template()
            self._history.begin_here()
            self.set_trait("can_undo", self._history.can_undo)

    @property
    def inference(self) -> bool:
        """Whether the drawing is inferred."""
        return self._modeller.inference

    @property
    def events(self) -> tuple[Event, ...]:
        """All events that changed anything, undos and redos included."""
        return tuple(self._events)

    @property
    def handles(self) -> np.ndarray:
        """Vertices (h,) int32 that are marked for gestures to move."""
        return self.refinement.handles

    @property
    def region(self) -> np.ndarray:
        """Vertices (r,) int32 of the region of interest: all of the head until one was drawn."""
        region = self.refinement.region
        everything = np.arange(len(self._modeller.soft), dtype=np.int32)
        return everything if region is None else everything[region]

    def draw(self, points: Any, view: str = "front", mirror: bool = False) -> None:
        """Draw a stroke.

        In follow-up sketching it closes the gap that an eraser opened; without one it is a wrinkle. In a side view it
        drags the profile to it.

        Parameters
        ----------
        points : (n, 2) array-like
            Canvas points, each coordinate within [-1, 2].
        view : str
            The view it is drawn in: "front"; in follow-up sketching also "left" and "right", for the profile.
        mirror : bool
            Whether to draw its mirror image with it: about the axis x = 0.5, in follow-up sketching about the middle of
            the head.

        Raises
        ------
        ValueError
            If the points are no stroke, the view is another, the stroke closes no gap, or the sketch is full; nothing
            has changed then.
        """
        self.do(Draw(points, view, mirror))

    def preview(self, points: Any, view: str = "front", mirror: bool = False) -> Modelled:
        """What `draw` would give; nothing changes.

        For a stroke that is still being drawn. Parameters and errors are those of `draw`. While a line that was erased
        is drawn anew, the head obeys it, but nothing is inferred from it yet; what the stroke has not come to is where
        it was.
        """
        state, stroke = self._history.state, Draw(points, view, mirror)
        with one_thread():
            if view != "front" or self.gap is None:
                return self._modeller.head(apply(state, stroke, self._modeller))
            stroke = replace(stroke, points=carried_on(self.gap, stroke.points))
            return self._modeller.obeying(apply(state, stroke, self._modeller), state)

    def erase(self, points: Any, radius: float = 0.02) -> bool:
        """Erase the ink under the eraser.

        In follow-up sketching, the first whole segment that it comes to, or what it covers of the silhouette. After a
        part of a line, only more of the same line can be erased until it was drawn anew.

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
        return self.do(Erase(path, radius))

    def clear(self) -> bool:
        """Remove all ink, or in the mode "refine" all marks: handles and region; False if there was none."""
        return self.do(Clear())

    def start_from_template(self) -> None:
        """Begin follow-up sketching with the lines of the template, in place of the drawing (paper 3.2)."""
        self.do(StartFromTemplate())

    def take_over(self, face: Face | np.ndarray, texture: Texture | None = None) -> None:
        """Make a head from elsewhere the session's: of a caricature, a portrait, another session.

        Its lines take the place of the drawing, and follow-up sketching begins. Its parameters are inferred from the
        lines; what they do not explain stays as a layer of its own while the lines are edited. The session's file holds
        the head itself, to 0.01 mm, and its texture.

        Parameters
        ----------
        face : Face or (V, 3) array
            Of the topology of the session's model, in millimetres and its frame.
        texture : Texture, optional
            What lies on it, as `Avatar.skin`; it stays on the head until another takes its place.

        Raises
        ------
        ValueError
            If it is no such head; nothing has changed then.
        """
        self.do(TakeOver(getattr(face, "vertices", face), texture))

    def exaggerate(self, amount: float) -> bool:
        """Multiply what makes the head differ from the mean face, all its layers together.

        The lines of the exaggerated head take the place of the drawing, until it is back at 1. Called again right
        after, it starts from the same head, and both are undone together.

        Parameters
        ----------
        amount : float
            From 0, the mean face, by 1, as it is, to 3.

        Returns
        -------
        bool
            Whether it changed anything.

        Raises
        ------
        ValueError
            If it is anything else; nothing has changed then.
        """
        return self.do(Exaggerate(amount))

    def cancel(self) -> bool:
        """Give back what was erased and waits to be drawn anew; False if nothing waits."""
        return self.do(Cancel())

    def profile(self, side: str = "left") -> np.ndarray:
        """The head's profile (p, 2) on the canvas of its "left" or "right" view, beside which `draw` drags it.

        Raises
        ------
        ValueError
            If the side is another.
        """
        return profile.drawn(self._modeller.head(self._history.state), side)

    def gesture(self, points: Any, view: View | str | None = None, tool: str | None = None) -> str:
        """Refine the head by a gesture: recognise the stroke, and do what it stands for (paper 3.3).

        Enters the mode "refine". The arrows undo and redo, in any mode.

        Parameters
        ----------
        points : (n, 2) array-like
            At least three canvas points.
        view : View or str, optional
            How the head is seen: a view of its own, or a preset in the frame of the drawing; None is the front.
        tool : str, optional
            A tool that was added by `register_gesture`; the stroke is not recognised then.

        Returns
        -------
        str
            The gesture's name.

        Raises
        ------
        ValueError
            If the stroke is no gesture or there is nothing that it could do; nothing has changed then.
        """
        event = self._named(Gesture(points, view, tool))
        self.do(event)
        return event.name or ""

    def preview_gesture(self, points: Any, view: View | str | None = None) -> Face | None:
        """The head that `gesture` would give, for a stroke that is still being drawn; nothing changes.

        Parameters and errors are those of `gesture`. None if it is an arrow, or a line that may become a roll.
        """
        event = self._named(Gesture(points, view))
        if event.name in ARROWS or may_change(event, self._history.state):
            return None
        with one_thread():
            return self._modeller.head(apply(self._history.state, event, self._modeller)).face

    def under_brush(self, path: Any, radius: float, view: View | str | None = None) -> np.ndarray:
        """The vertices (k,) of the visible surface that a brush would mark; pass them to `brush`.

        Parameters
        ----------
        path : (n, 2) array-like
            Where its middle goes, canvas points.
        radius : float
            In canvas units, from 0.001 to 1.
        view : View or str, optional
            As for `gesture`.

        Raises
        ------
        ValueError
            If the path is no stroke, the radius is out of range, or the view is none.
        """
        shown = self._modeller.head(self._history.state)
        seen, face = as_seen(view, shown.frame), shown.face
        return brushed(as_stroke(path), as_radius(radius), face.vertices, face.faces, seen, self._modeller.soft)

    def brush(self, vertices: Any, erase: bool = False) -> bool:
        """Mark vertices of the head as handles, or unmark them; enters the mode "refine".

        Gestures move all of them, those that a view hides as well, if some are seen in it.

        Parameters
        ----------
        vertices : (k,) array-like of int
            Their numbers. Those of eyes, teeth and tongue do not count: these go along with the skin about them.
        erase : bool
            Whether to unmark them.

        Returns
        -------
        bool
            Whether it changed anything.

        Raises
        ------
        ValueError
            If they are no vertices of the head, or none that deforms; nothing has changed then.
        """
        return self.do(Brush(vertices, erase))

    def undo(self) -> bool:
        """Take the last edit back; False if there was none."""
        return self.do(Undo())

    def redo(self) -> bool:
        """Do the edit last taken back again; False if there was none, or something was done since."""
        return self.do(Redo())

    def dumps(self) -> str:
        """The session as text, from which `loads` replays it."""
        return file.dumps(self._events, self.inference)

    @classmethod
    def loads(cls, text: str, regressor: FaceRegressor | None = None, inference: bool | None = None) -> Self:
        """Replay a session from its text.

        Parameters
        ----------
        text : str
        regressor : object with `infer(sketch) -> Inference`, optional
            As for a new session.
        inference : bool, optional
            Whether the drawings are inferred; by default as they were in the session that was saved.

        Raises
        ------
        SessionFileError
            If the text is no session that can be replayed; the message says what is wrong, and where.
        """
        events, inferred = file.loads(text)
        session = cls(regressor, inferred if inference is None else inference)
        started = perf_counter()
        for number, event in enumerate(events, start=2):
            try:
                session._record(event)
            except ValueError as error:
                raise SessionFileError(f"line {number} of the session cannot be replayed: {error}") from error
        session._follow(started)
        return session

    def another(self, text: str) -> Self:
        """Replay a session from its text as `loads` does, with the network and the model of this one.

        If this one saves itself, the other does so too, to the same file.
        """
        session = type(self).loads(text, self.regressor if self.inference else self._modeller.given)
        if self._autosave is not None:
            session.autosave(self._autosave.path)
        return session

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the session to a file; a former file stays as it was if that fails."""
        textfile.write(path, self.dumps())

    def autosave(self, path: str | os.PathLike[str]) -> None:
        """Write the session to a file now and after every change, before its head is inferred.

        However the kernel ends, `load` then gives the session up to the last finished stroke. A change that cannot be
        written is made all the same, and raises what `save` would.
        """
        self._autosave = Autosave(path)
        self._autosave.write(self._events, self.inference)

    @property
    def autosaved(self) -> str | os.PathLike[str] | None:
        """The file that `autosave` keeps up to date, if any."""
        return None if self._autosave is None else self._autosave.path

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], regressor: FaceRegressor | None = None, inference: bool | None = None
    ) -> Self:
        """Replay a session from its file; parameters are those of `loads`.

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
            return cls.loads(text, regressor, inference)
        except SessionFileError as error:
            raise SessionFileError(f"{os.fspath(path)}: {error}") from error

    @property
    def awake(self) -> bool:
        """Whether the network is there: the first stroke would wait for it otherwise."""
        return not self.inference or self._modeller.given is not None

    def prepare(self) -> None:
        """Load and compute what heads need, so that the first stroke does not wait for it."""
        self._modeller.prepare()

    @default("layers")
    def _layers_of_no_drawing(self) -> Layers:
        return self._modeller.head(State()).layers

    @default("face")
    def _face_of_no_drawing(self) -> Any:
        return self.layers.head

    def do(self, event: Event) -> bool:
        """Do an event, as all other methods do it: one of another session's `events`, for instance.

        Returns
        -------
        bool
            Whether it changed anything.

        Raises
        ------
        ValueError
            If it cannot be done; nothing has changed then.
        TypeError
            If it is no event.
        """
        if not isinstance(event, Event):
            raise TypeError(f"a session does an Event, as those of Session.events; given {type(event).__name__}")
        started = perf_counter()
        with one_thread():
            changed = self._record(event)
        if changed:
            try:
                if self._autosave is not None:
                    self._autosave.write(self._events, self.inference)
            finally:
                self._follow(started)
        return changed

    def _named(self, event: Gesture) -> Gesture:
        return named(event, self._history.state, self._modeller)

    def _record(self, event: Event) -> bool:
        if isinstance(event, Gesture):
            event = self._named(event)  # those of old files have no name yet
        outcome, followup = None, self._history.state.followup
        waits = self._history.state.mode == "followup" and followup is not None and followup.gap is not None
        if waits and isinstance(event, Draw) and event.view == "front" and event.spacing is None:
            event, outcome = obeyed(self._history.state, event, self._modeller)
        changed = self._history.record(event, outcome)
        if changed:
            if _replaces(event, self._events):
                self._events.pop()
            self._events.append(event)
        return changed

    def _follow(self, started: float) -> None:
        """Infer the head of the present state and publish both; if that fails, still publish the drawing."""
        state = self._history.state
        traits = {
            "mode": state.mode,
            "gap": state.followup and state.followup.gap,
            "sketch": state.sketch,
            "refinement": state.refinement,
            "texture": None if state.residual is None else state.residual.texture,
            "exaggeration": 1.0 if state.exaggeration is None else state.exaggeration.amount,
            "can_undo": self._history.can_undo,
            "can_redo": self._history.can_redo,
            "timings": {"sketch": _milliseconds_since(started)},
        }
        try:
            with one_thread():
                head = self._modeller.head(state)
            traits |= {
                "sketch": state.sketch.renamed(head.names),
                "face": head.face,
                "layers": head.layers,
                "frame": head.frame,
                "timings": {**traits["timings"], **head.timings},
            }
        finally:
            traits["timings"]["total"] = _milliseconds_since(started)
            with self.hold_trait_notifications():
                for name, value in traits.items():
                    self.set_trait(name, value)

    @property
    def regressor(self) -> FaceRegressor:
        """What infers the heads; the shipped one is loaded when it is first asked for."""
        return self._modeller.regressor


def _replaces(event: Event, before: list[Event]) -> bool:
    """Whether nothing is left of the event before: of a slider's moves the last one counts."""
    moved = isinstance(event, Exaggerate) and event.amount != 1.0
    return moved and bool(before) and isinstance(before[-1], Exaggerate)


def _milliseconds_since(started: float) -> float:
    return 1e3 * (perf_counter() - started)
