"""Drawing in the Studio: the tools of the pad, what strokes there do, and the side views that drag the profile."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import numpy as np
from ipywidgets import jslink

from ..face import Face
from ..session import Session
from ..sketch import SILHOUETTE, Segment, Sketch
from . import toolbar
from .head_view import HeadView
from .ink import TOOLS
from .pad import Pad
from .status import Status, expected_next, said
from .welcome import beyond

FRONT, SIDES = "front", {"left": "right", "right": "left"}

# What is said when a toggle is switched on, and off.
_SWITCHED = {
    "mirror": ("Each stroke is drawn on both sides.", "Strokes are drawn on one side."),
    "ghost": ("The head's own lines lie under the ink.", "The head's own lines are hidden."),
    "live": ("The head follows while you draw.", "The head follows once a stroke has ended."),
}


class Drawing:
    """What the Studio has on the page while its session is drawn.

    Parameters
    ----------
    session_of, face_of : callable
        Give the session on show, and its head.
    head : HeadView
    show_head : callable
        Shows the session's head again, after another one was shown in passing.
    expected : callable
        Gives what to do next, as a sentence.
    status : Status

    Attributes
    ----------
    tools, more : widgets
        Pen and eraser; what else concerns the pad.
    pad : Pad
    """

    def __init__(
        self,
        session_of: Callable[[], Session],
        face_of: Callable[[], Face],
        head: HeadView,
        show_head: Callable[[], None],
        expected: Callable[[], str],
        status: Status,
    ) -> None:
        self._session_of, self._face_of, self._head = session_of, face_of, head
        self._show_head, self._expected, self._status = show_head, expected, status
        self._side = FRONT  # the view that the pad shows: in follow-up sketching also the profile's
        self.pad = Pad()
        tools = toolbar.choice(*TOOLS)
        mirror, self._ghost, live = (toolbar.toggle(name) for name in ("mirror", "ghost", "live"))
        live.value = True
        self._cancel = toolbar.button("cancel")
        self.tools = toolbar.bar((tools,))
        self.more = toolbar.bar((self._cancel,), (mirror, self._ghost, live))
        # Linked in the browser, so that a stroke right after a key is drawn with the tool that the key chose.
        jslink((tools, "index"), (self.pad.widget, "tool"))
        jslink((mirror, "value"), (self.pad.widget, "mirror"))
        jslink((live, "value"), (self.pad.widget, "live"))
        self._ghost.observe(lambda _: self.show(), "value")
        for name, toggle in (("mirror", mirror), ("ghost", self._ghost), ("live", live)):
            toggle.observe(lambda change, name=name: self._on_switch(name, change["new"]), "value")
        self._cancel.on_click(lambda _: self._on_cancel())
        self.pad.widget.on_stroke(self._on_stroke)
        self.pad.widget.on_partial(self._on_partial)
        self.pad.widget.on_cancel(show_head)

    @property
    def expected(self) -> str:
        """What to draw next, as a sentence."""
        session = self._session_of()
        if self._side != FRONT:
            return "Draw beside the profile to drag it."
        return beyond(session) or expected_next(session.sketch, session.mode, session.gap)

    def show(self) -> None:
        """Show the drawing of the session, or its profile."""
        session = self._session_of()
        edited = session.mode == "followup"
        if self._side != FRONT and (not edited or session.gap is not None):  # a gap is one of the front
            self._side = FRONT
            self._head.look(FRONT)
        toolbar.set_useful(self._cancel, session.gap is not None)
        if self._side != FRONT:
            self.pad.show(Sketch((Segment(SILHOUETTE, session.profile(self._side)),)))
            return
        ghost = self._face_of().sketch(wrinkles=False, view=session.frame) if self._ghost.value else None
        self.pad.widget.middle = float(session.frame.centre[0]) if edited else 0.5
        self.pad.show(session.sketch, ghost, session.gap, by_piece=edited)

    def turn(self, view: str) -> bool:
        """Show the pad as the head is seen now: from a side in follow-up sketching, else from the front.

        Returns
        -------
        bool
            Whether that is another view; what was erased is drawn anew in the one that it was erased in.
        """
        session = self._session_of()
        side = view if session.mode == "followup" and view in SIDES else FRONT
        if side == self._side or session.gap is not None:
            return False
        self._side = side
        self.show()
        return True

    def _on_switch(self, name: str, on: bool) -> None:
        said, otherwise = _SWITCHED[name]
        self._status.say(said if on else otherwise, self._expected())

    def _on_stroke(self, points: np.ndarray, tool: str, mirror: bool) -> None:
        session = self._session_of()
        if not session.awake:
            self._status.say("The network is waking up; the head follows in a moment.")
        before = session.sketch
        with self._status.reporting("The head could not follow this stroke, the drawing is kept"):
            self._status.say(self._did(session, points[:, :2], tool, mirror), self._expected())
        if session.sketch is before:  # the head may have followed what came to nothing
            self._show_head()

    def _did(self, session: Session, points: np.ndarray, tool: str, mirror: bool) -> str:
        """Draw or erase; what happened, as a sentence."""
        gap = session.gap
        if tool == "eraser" and self._side != FRONT:
            return "The profile is not erased."
        if tool == "eraser":
            if session.erase(points, radius=self.pad.widget.radius):
                return "Erased."
            return "Nothing to erase there." if gap is None else "What was erased comes first."
        session.draw(points, view=self._side, mirror=mirror and self._side == FRONT)
        if self._side != FRONT:
            return "The profile follows."
        if gap is not None:
            other = SIDES.get(gap.name.partition("_")[0]) if mirror else None
            return f"The {said(gap.name)} is drawn anew{f', and the {other} one with it' if other else ''}."
        if session.mode == "followup":
            return "A wrinkle is drawn; to draw a line anew, erase it first."
        return "Both strokes drawn." if mirror else "Stroke drawn."

    def _on_partial(self, points: np.ndarray, mirror: bool) -> None:
        session = self._session_of()
        if not session.awake:
            return
        with suppress(Exception):  # what is no stroke yet may become one; what fails is told when the stroke ends
            preview = session.preview(points[:, :2], self._side, mirror=mirror and self._side == FRONT)
            self._head.show(preview.face, preview.frame, passing=True)

    def _on_cancel(self) -> None:
        with self._status.reporting("What was erased could not be put back"):
            happened = "It is as it was." if self._session_of().cancel() else "Nothing waits to be drawn anew."
            self._status.say(happened, self._expected())
