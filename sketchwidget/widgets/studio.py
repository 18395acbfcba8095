"""The Studio: draw a face on the pad, and the head beside it follows."""

from __future__ import annotations

from contextlib import suppress
from threading import Thread
from typing import Any

import numpy as np
import traitlets
from ipywidgets import Box, VBox, jslink

from ..face import Face, FaceModel
from ..session import Session
from ..sketch import SILHOUETTE, Segment, Sketch
from . import toolbar
from .download import Downloads
from .head_view import HeadView
from .keyboard import Keyboard
from .pad import Pad
from .refine_pad import TOOLS as REFINING_TOOLS
from .refining import EXPECTED, Refining
from .status import Status, expected_next, said

TOOLS = ("pen", "eraser")
MODES = ("initial", "followup", "refine")
VIEWS = ("front", "left", "right", "three-quarter")
EXPORTS = {"obj": "model/obj", "glb": "model/gltf-binary"}
SESSION_NAME, SESSION_TYPE = "drawing.jsonl", "application/jsonl"


class Studio(VBox):
    """A drawing pad and the 3D head that follows it.

    Parameters
    ----------
    session : Session, optional
        What is drawn and the face it gives; a new one if not given. Scripts may work on it too: the Studio shows what
        it becomes. Another session may be assigned to the trait at any time.

    Attributes
    ----------
    session : Session
        The session on show.
    """

    session = traitlets.Instance(Session)

    def __init__(self, session: Session | None = None) -> None:
        session = Session() if session is None else session
        # A session infers its first face when asked for it; the mean face needs no network, so the page has it at once.
        self._resting_face = session.face if session.trait_has_value("face") else FaceModel.load().face()
        self._pad = Pad()
        self._head = HeadView(self._resting_face)
        self._status = Status()
        self._downloads = Downloads()
        self._side = "front"  # the view that the pad shows: in follow-up sketching also the profile's
        self._shown: tuple[Any, ...] = (None,) * 7  # what of the session is on show
        self._loaded: tuple[Session, Session, int] | None = None  # former, loaded, and the latter's number of events
        super().__init__()
        self.children = self._layout()
        self.add_class("sketchwidget-studio")
        self._pad.widget.on_stroke(self._on_stroke)
        self._pad.widget.on_partial(self._on_partial)
        self._pad.widget.on_cancel(self._show_head)
        self._head.widget.on_ready(self._wake)
        self._waking = Thread(target=_wake, args=[session], daemon=True)
        self.session = session

    def __repr__(self) -> str:
        return f"Studio({self.session!r})"

    # -- building ------------------------------------------------------------------------------------------------------

    def _layout(self) -> list[Any]:
        self._mode = toolbar.choice(*MODES)
        self._tools = toolbar.choice(*TOOLS)
        self._mirror, self._ghost, self._live = (toolbar.toggle(name) for name in ("mirror", "ghost", "live"))
        self._live.value = True
        self._undo, self._redo, self._clear = (toolbar.button(name) for name in ("undo", "redo", "clear"))
        self._cancel, template = toolbar.button("cancel"), toolbar.button("template")
        views = [toolbar.button(name) for name in VIEWS]
        save, load = toolbar.button("save"), toolbar.picker("load", ".jsonl,.json")
        exports = [toolbar.button(name) for name in EXPORTS]

        # Linked in the browser, so that a stroke right after a key is drawn with the tool that the key chose.
        jslink((self._tools, "index"), (self._pad.widget, "tool"))
        jslink((self._mirror, "value"), (self._pad.widget, "mirror"))
        jslink((self._live, "value"), (self._pad.widget, "live"))
        self._ghost.observe(lambda _: self._show_drawing(), "value")
        self._undo.on_click(lambda _: self._on_undo())
        self._redo.on_click(lambda _: self._on_redo())
        self._clear.on_click(lambda _: self._on_clear())
        self._cancel.on_click(lambda _: self._on_cancel())
        template.on_click(lambda _: self._on_template())
        self._mode.observe(self._on_mode, "value")
        for name, button in zip(VIEWS, views, strict=True):
            button.on_click(lambda _, name=name: self._on_view(name))
        save.on_click(lambda _: self._on_save())
        load.observe(self._on_load, "value")
        for name, button in zip(EXPORTS, exports, strict=True):
            button.on_click(lambda _, name=name: self._on_export(name))

        title = _classed(
            Box([toolbar.bar((self._mode,)), toolbar.bar((template, save, load), tuple(exports))]), "sketchwidget-title"
        )
        edits = (self._undo, self._redo, self._cancel, self._clear)
        pad_bar = toolbar.bar((self._tools,), edits, (self._mirror, self._ghost, self._live))
        drawing = _classed(VBox([pad_bar, self._pad.widget]), "sketchwidget-panel")
        head_bar = _classed(toolbar.bar(tuple(views)), "sketchwidget-views")
        self._refining = Refining(lambda: self.session, self._head, self._status)
        head_bars = Box([head_bar, self._refining.bar])
        head = _classed(VBox([head_bars, self._head.widget, self._refining.chart]), "sketchwidget-panel")
        desk = _classed(Box([drawing, head]), "sketchwidget-desk")
        keyboard = Keyboard(bindings=toolbar.bindings(TOOLS, MODES, REFINING_TOOLS))
        return [title, desk, self._status, self._downloads, keyboard, self._refining.pad]

    # -- the session, shown --------------------------------------------------------------------------------------------

    @traitlets.observe("session")
    def _on_session(self, change: dict[str, Any]) -> None:
        if isinstance(change["old"], Session):
            change["old"].unobserve(self._on_change)
        self.session.observe(self._on_change)
        self._show_all()
        self._status.say(self._expected)

    def _on_change(self, change: dict[str, Any]) -> None:
        # There is one call a trait, but the session sets all of them before it tells of any: the first shows the whole.
        session = self.session
        state = (session.sketch, self._face, session.frame, session.timings, session.gap)
        state += (session.mode, session.refinement)
        if any(new is not old for new, old in zip(state, self._shown, strict=True)):
            self._shown = state
            with self._status.reporting("The Studio could not show the change"):
                self._show_all()

    def _show_all(self) -> None:
        session = self.session
        if session.mode != "followup":
            self._side = "front"
        self._show_head()
        self._show_drawing()
        self._refining.show()
        toolbar.set_useful(self._undo, session.can_undo or self._just_loaded)
        toolbar.set_useful(self._redo, session.can_redo)
        marked = len(session.handles) or session.refinement.region is not None
        toolbar.set_useful(self._clear, bool(marked if session.mode == "refine" else len(session.sketch)))
        toolbar.set_useful(self._cancel, session.gap is not None)
        self._mode.value = session.mode if session.mode in MODES else None
        self._status.show_figures(session.mode, session.timings)

    def _show_head(self) -> None:
        self._head.show(self._face, self.session.frame)

    def _show_drawing(self) -> None:
        session = self.session
        if self._side != "front":
            self._pad.show(Sketch((Segment(SILHOUETTE, session.profile(self._side)),)))
            return
        ghost = self._face.sketch(wrinkles=False, view=session.frame) if self._ghost.value else None
        self._pad.show(session.sketch, ghost, session.gap, by_piece=session.mode == "followup")

    @property
    def _expected(self) -> str:
        if self.session.mode == "refine":
            return EXPECTED
        if self._side != "front":
            return "Draw beside the profile to drag it."
        return expected_next(self.session.sketch, self.session.mode, self.session.gap)

    @property
    def _face(self) -> Face:
        return self.session.face if self.session.trait_has_value("face") else self._resting_face

    def _wake(self) -> None:
        """Load the network while the user looks at the page: the first stroke would wait some seconds for it."""
        if not self._waking.ident:
            self._waking.start()

    # -- what the user does --------------------------------------------------------------------------------------------

    def _on_stroke(self, points: np.ndarray, tool: str, mirror: bool) -> None:
        if not self.session.awake:
            self._status.say("The network is waking up; the head follows in a moment.")
        before = self.session.sketch
        with self._status.reporting("The head could not follow this stroke, the drawing is kept"):
            self._status.say(self._did(points[:, :2], tool, mirror), self._expected)
        if self.session.sketch is before:  # the head may have followed what came to nothing
            self._show_head()

    def _did(self, points: np.ndarray, tool: str, mirror: bool) -> str:
        """Draw or erase; what happened, as a sentence."""
        session, gap = self.session, self.session.gap
        if tool == "eraser" and self._side != "front":
            return "The profile is not erased."
        if tool == "eraser":
            if session.erase(points, radius=self._pad.widget.radius):
                return "Erased."
            return "Nothing to erase there." if gap is None else "What was erased comes first."
        session.draw(points, view=self._side, mirror=mirror and self._side == "front")
        if self._side != "front":
            return "The profile follows."
        if gap is not None:
            return f"The {said(gap.name)} is drawn anew."
        return "Both strokes drawn." if mirror else "Stroke drawn."

    def _on_partial(self, points: np.ndarray, mirror: bool) -> None:
        # Half a replacement would be stretched over the whole gap.
        if not self.session.awake or self.session.gap is not None or self._side != "front":
            return
        with suppress(Exception):  # what is no stroke yet may become one; what fails is told when the stroke ends
            preview = self.session.preview(points[:, :2], mirror=mirror)
            self._head.show(preview.face, preview.frame, passing=True)

    def _on_undo(self) -> None:
        with self._status.reporting("Nothing could be undone"):
            if self._just_loaded and self._loaded is not None:
                self.session = self._loaded[0]
                self._status.say("The drawing from before the loading is back.")
            else:
                happened = "Undone." if self.session.undo() else "Nothing to undo."
                self._status.say(happened, self._expected)

    def _on_redo(self) -> None:
        with self._status.reporting("Nothing could be redone"):
            happened = "Redone." if self.session.redo() else "Nothing to redo."
            self._status.say(happened, self._expected)

    def _on_clear(self) -> None:
        with self._status.reporting("The drawing could not be cleared"):
            self.session.clear()
            what = "marks" if self.session.mode == "refine" else "drawing"
            self._status.say(f"Cleared; undo brings the {what} back.", self._expected)

    def _on_cancel(self) -> None:
        with self._status.reporting("What was erased could not be put back"):
            happened = "It is as it was." if self.session.cancel() else "Nothing waits to be drawn anew."
            self._status.say(happened, self._expected)

    def _on_template(self) -> None:
        with self._status.reporting("The template could not be drawn"):
            self.session.start_from_template()
            self._status.say("These are the lines of the template; undo brings the drawing back.", self._expected)

    def _on_mode(self, change: dict[str, Any]) -> None:
        mode = change["new"]
        if mode in (None, self.session.mode):
            return
        with self._status.reporting("The mode could not be changed"):
            self.session.mode = mode
            self._status.say(self._expected)
        self._mode.value = self.session.mode

    def _on_view(self, name: str) -> None:
        self._head.look(name)
        side = name if name in ("left", "right") and self.session.mode == "followup" else "front"
        if side != self._side and self.session.gap is None:
            self._side = side
            self._show_drawing()
            self._status.say(self._expected)

    def _on_export(self, suffix: str) -> None:
        with self._status.reporting("The head could not be exported"):
            self._downloads.save(f"head.{suffix}", self._face.to_bytes(suffix), EXPORTS[suffix])
            self._status.say(f"The head is exported as head.{suffix}.")

    def _on_save(self) -> None:
        with self._status.reporting("The session could not be saved"):
            self._downloads.save(SESSION_NAME, self.session.dumps().encode(), SESSION_TYPE)
            self._status.say(f"The session is saved as {SESSION_NAME}; load it to go on from here.")

    def _on_load(self, change: dict[str, Any]) -> None:
        if not change["new"]:
            return
        file = change["new"][0]
        change["owner"].value = ()  # so that the same file can be picked again
        with self._status.reporting(f"{file.name} was not loaded, the drawing is kept"):
            loaded = self.session.another(bytes(file.content).decode())
            self._loaded = (self.session, loaded, len(loaded.events))
            self.session = loaded
            self._status.say(f"{file.name} is loaded; undo brings the former drawing back.")

    @property
    def _just_loaded(self) -> bool:
        """Whether the session on show is as it was loaded from a file, so that undo undoes the loading."""
        if self._loaded is None:
            return False
        _, loaded, events = self._loaded
        return self.session is loaded and len(loaded.events) == events


def _wake(session: Session) -> None:
    # What fails here fails again, and is told, when it is needed.
    with suppress(Exception):
        session.prepare()


def _classed(widget: Any, name: str) -> Any:
    widget.add_class(name)
    return widget
