"""The refinement mode of the Studio: tools over the head, what strokes there do, and a chart of the gestures."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

import igl
import numpy as np
from ipywidgets import HTML, jslink

from ..geometry import View
from ..gesture import GESTURES
from ..gesture.names import ARROWS, LINE
from ..gesture.shapes import example
from ..session import Session
from ..session.behaviours import tools
from . import toolbar
from .head_view import HeadView
from .refine_pad import BRUSHES, TOOLS, RefinePad
from .status import Status, counted
from .welcome import beyond

EXPECTED = "Brush handles, then draw a gesture on the head; the right button turns it."
EFFECTS = {
    "line": "moves the handles; without any, drags the outline",
    "region": "bounds what may move",
    "left arrow": "undo",
    "right arrow": "redo",
    **{f"up roll {level}": f"bulges the handles, level {level}" for level in (1, 2, 3)},
    **{f"down roll {level}": f"depresses the handles, level {level}" for level in (1, 2, 3)},
}


class Refining:
    """What the Studio has on the page while its session is refined.

    Parameters
    ----------
    session_of : callable
        Gives the session on show.
    head : HeadView
        The head that the pad lies over.
    status : Status

    Attributes
    ----------
    bar, chart : widgets
        Tools and the chart of gestures; shown in the mode "refine" only.
    pad : RefinePad
    """

    def __init__(self, session_of: Callable[[], Session], head: HeadView, status: Status) -> None:
        self._session_of, self._head, self._status = session_of, head, status
        self._shown: Any = None
        self._active = False
        self.pad = RefinePad()
        self._tools = toolbar.choice(*TOOLS)
        self._help = toolbar.toggle("chart")
        self.bar = toolbar.bar((self._tools,), (self._help,))
        self.chart = HTML(chart())
        self.chart.add_class("sketchwidget-chart")
        # Linked in the browser, as the tools of the drawing pad are.
        jslink((self._tools, "index"), (self.pad, "tool"))
        self._help.observe(lambda _: self._show_chart(), "value")
        self.pad.on_stroke(self._on_stroke)
        self.pad.on_partial(self._on_partial)
        self.pad.on_cancel(self._show_head)
        self.bar.layout.display = self.chart.layout.display = "none"

    def show(self, hidden: bool = False) -> None:
        """Show the marks of the session, if it is being refined and no other tab hides that."""
        session = self._session_of()
        active = self._active = session.mode == "refine" and not hidden
        self.pad.active = active
        self.bar.layout.display = "" if active else "none"
        self._show_tools()
        self._show_chart()
        if active and session.refinement is not self._shown:
            self._shown = session.refinement
            region = session.refinement.region
            border = np.empty((0, 2), dtype=np.int32) if region is None else border_of(region, session.face.faces)
            self.pad.show(session.handles, border)

    def _show_tools(self) -> None:
        """Those that users added, beside the others."""
        names = (*TOOLS, *tools())
        if names != self.pad.tools:
            self.pad.tools = names
            toolbar.extend(self._tools, TOOLS, names[len(TOOLS) :])

    def _show_chart(self) -> None:
        wanted = self._active and self._help.value
        self.chart.layout.display = "" if wanted else "none"

    def _show_head(self) -> None:
        session = self._session_of()
        self._head.show(session.face, session.frame)

    def _on_stroke(self, points: np.ndarray, tool: str, view: View) -> None:
        session = self._session_of()
        before = session.face
        with self._status.reporting("Nothing was changed"):
            try:
                happened = self._did(session, points, tool, view)
            except ValueError as error:
                self.pad.flash(str(error).partition(":")[0], good=False)
                raise
            self.pad.flash(happened)
            self._status.say(f"{happened[0].upper()}{happened[1:]}.", beyond(session) or EXPECTED)
        if session.face is before:  # the head may have followed what came to nothing
            self._show_head()

    def _did(self, session: Session, points: np.ndarray, tool: str, view: View) -> str:
        if tool not in BRUSHES:
            before = len(session.events)
            name = session.gesture(points, view, None if tool == "gesture" else tool)
            if name in ARROWS and len(session.events) == before:
                return f"{name}: nothing to {EFFECTS[name]}"
            if name == LINE:
                return "line: moves the handles" if len(session.handles) else "line: drags the outline"
            return told(name)
        marks = session.under_brush(points, self.pad.radius, view)
        if not len(marks):
            raise ValueError("the brush touched nothing of the head that deforms")
        changed = session.brush(marks, erase=tool == "unbrush")
        return f"{counted(len(session.handles), 'handle')} marked" if changed else "No other handles"

    def _on_partial(self, points: np.ndarray, view: View) -> None:
        # What is no gesture yet may become one; between two loops of a roll the head stays as the first has made it.
        with suppress(ValueError):
            session = self._session_of()
            face = session.preview_gesture(points, view)
            self._head.show(session.face if face is None else face, session.frame, passing=True)


def border_of(region: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """The edges (e, 2) about the triangles of a region (V,) bool."""
    return np.asarray(igl.boundary_facets(faces[region[faces].all(axis=1)])[0])


def told(name: str) -> str:
    """A gesture and what it does; users' own ones have no word for that."""
    return f"{name}: {EFFECTS[name]}" if name in EFFECTS else name


def chart() -> str:
    """The gestures and what they do, as a page's markup (after Figure 4 of the paper)."""
    return "".join(f"<figure>{_drawn(name)}<figcaption>{name}</figcaption></figure>" for name in GESTURES)


def _drawn(name: str) -> str:
    points = example(name, np.array([24, 24]), 40)
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return (
        f'<svg viewBox="0 0 48 48" role="img" aria-label="{name}"><title>{told(name)}</title>'
        f'<polyline points="{path}"/><circle cx="{points[0, 0]:.1f}" cy="{points[0, 1]:.1f}" r="2.4"/></svg>'
    )
