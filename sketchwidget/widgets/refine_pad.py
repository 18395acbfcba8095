"""The pad over the head: gestures and brushes, and what they marked."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import anywidget
import numpy as np
import traitlets
from ipywidgets import CallbackDispatcher

from ..geometry import View
from ..session.behaviours import PEN_TOOLS as TOOLS
from .pacing import paced

BRUSHES = ("brush", "unbrush")


class RefinePad(anywidget.AnyWidget):
    """Takes the pointer over the head of the Studio that it is in, and shows handles and region there.

    It has no place of its own on the page. The message format is in ``refine_pad.js``.
    """

    _esm = paced("refine_pad.js")

    tool = traitlets.Int(0, min=0, help="index into tools").tag(sync=True)
    active = traitlets.Bool(False, help="whether the pad takes the pointer").tag(sync=True)
    radius = traitlets.Float(0.02, help="of the brushes, in canvas units").tag(sync=True)

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.tools: tuple[str, ...] = TOOLS  # and those that users added
        self._marks = (np.empty(0, dtype="<i4"), np.empty((0, 2), dtype="<i4"))
        self._stroke_callbacks = CallbackDispatcher()
        self._partial_callbacks = CallbackDispatcher()
        self._cancel_callbacks = CallbackDispatcher()
        self._flash = ("", True)
        self.on_msg(self._receive)

    def on_stroke(self, callback: Callable[[np.ndarray, str, View], None]) -> None:
        """Call ``callback(points, tool, view)`` for each stroke that ends.

        ``points`` is (n, 2) float32 in canvas units; ``tool`` is one of ``tools``; ``view`` is how the head was seen.
        """
        self._stroke_callbacks.register_callback(callback)

    def on_partial(self, callback: Callable[[np.ndarray, View], None]) -> None:
        """Call ``callback(points, view)`` for what there is of a gesture that is still being drawn."""
        self._partial_callbacks.register_callback(callback)

    def on_cancel(self, callback: Callable[[], None]) -> None:
        """Call ``callback()`` when a stroke ends that does not count."""
        self._cancel_callbacks.register_callback(callback)

    def flash(self, text: str, good: bool = True) -> None:
        """Show a few words beside the pointer once the stroke at hand is answered."""
        self._flash = (text, good)

    def show(self, handles: np.ndarray, border: np.ndarray) -> None:
        """Show handles (h,) and the edges (e, 2) of a region's border, by the numbers of their vertices."""
        self._marks = (np.ascontiguousarray(handles, dtype="<i4"), np.ascontiguousarray(border, dtype="<i4"))
        self._send_marks()

    def _send_marks(self) -> None:
        self.send({"type": "marks"}, [part.data for part in self._marks])

    def _receive(self, _: Any, content: dict[str, Any], buffers: list[memoryview]) -> None:
        kind = content.get("type")
        if kind == "ready":
            self._send_marks()
        elif kind == "cancelled":
            self._cancel_callbacks()
        elif kind in ("partial", "stroke"):
            points = np.frombuffer(buffers[0], dtype="<f4").reshape(-1, 4)[:, :2]
            self._flash = ("", True)
            try:
                if kind == "partial":
                    self._partial_callbacks(points, View(**content["view"]))
                else:
                    self._stroke_callbacks(points, self.tools[content["tool"]], View(**content["view"]))
            finally:
                text, good = self._flash
                said = {"text": text, "good": good, "partial": kind == "partial"}
                self.send({"type": "answer", "stroke": content["stroke"], **said})
