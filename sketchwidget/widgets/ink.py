"""Ink under the pen: the browser draws it at once and sends each stroke whole."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import anywidget
import numpy as np
import traitlets
from ipycanvas import MultiCanvas
from ipywidgets import CallbackDispatcher, widget_serialization

from .pacing import paced

TOOLS = ("pen", "eraser")


class Ink(anywidget.AnyWidget):
    """Shows an ipycanvas `MultiCanvas` and turns pointer input on it into strokes.

    The last layer of the canvas holds the ink that the kernel has not answered yet; the one below it holds the lines,
    which the eraser rubs out at once until the kernel redraws them. The message format is in ``ink.js``.

    Parameters
    ----------
    canvas : ipycanvas.MultiCanvas
        The layers, square, seen as the unit square. The browser keeps its size at the pixels it covers on screen.
    """

    _esm = paced("ink.js")

    canvas = traitlets.Instance(MultiCanvas).tag(sync=True, **widget_serialization)
    tool = traitlets.Int(0, min=0, max=len(TOOLS) - 1, help="index into TOOLS").tag(sync=True)
    mirror = traitlets.Bool(False, help="draw each stroke on both sides").tag(sync=True)
    middle = traitlets.Float(0.5, help="x of the axis of mirrored strokes, in canvas units").tag(sync=True)
    colour = traitlets.Unicode("#444444", help="of the wet ink").tag(sync=True)
    line_width = traitlets.Float(0.005, help="of the wet ink, in canvas units").tag(sync=True)
    radius = traitlets.Float(0.02, help="of the eraser, in canvas units").tag(sync=True)
    pieces = traitlets.List(help="polylines that the eraser takes whole, flat lists of x and y").tag(sync=True)
    outline = traitlets.List(help="a polyline of which the eraser takes what it covers, or nothing").tag(sync=True)
    live = traitlets.Bool(False, help="send the pen's stroke while it is drawn").tag(sync=True)
    invitation = traitlets.Unicode("", help="shown faintly on the pad").tag(sync=True)

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._stroke_callbacks = CallbackDispatcher()
        self._partial_callbacks = CallbackDispatcher()
        self._cancel_callbacks = CallbackDispatcher()
        self._ready_callbacks = CallbackDispatcher()
        self.on_msg(self._receive)

    def on_stroke(self, callback: Callable[[np.ndarray, str, bool], None]) -> None:
        """Call ``callback(points, tool, mirror)`` for each stroke that ends.

        ``points`` is (n, 4) float32: x and y in canvas units, pressure 0..1, milliseconds since the stroke began;
        ``tool`` is one of `TOOLS`. The wet ink is taken off the pad when the callback returns.
        """
        self._stroke_callbacks.register_callback(callback)

    def on_partial(self, callback: Callable[[np.ndarray, bool], None]) -> None:
        """Call ``callback(points, mirror)`` for what there is of a pen's stroke that is still being drawn.

        At most 15 times a second, only if `live`, and never while an earlier call has not returned; see ``pacing.js``.
        """
        self._partial_callbacks.register_callback(callback)

    def on_cancel(self, callback: Callable[[], None]) -> None:
        """Call ``callback()`` when a stroke ends that does not count: what was drawn or rubbed out of it must go."""
        self._cancel_callbacks.register_callback(callback)

    def on_ready(self, callback: Callable[[], None]) -> None:
        """Call ``callback()`` when a page shows the pad."""
        self._ready_callbacks.register_callback(callback)

    def _receive(self, _: Any, content: dict[str, Any], buffers: list[memoryview]) -> None:
        if content.get("type") == "ready":
            self._ready_callbacks()
        elif content.get("type") == "cancelled":
            self._cancel_callbacks()
        elif content.get("type") == "partial":
            try:
                self._partial_callbacks(_points(buffers), bool(content["mirror"]))
            finally:
                self.send({"type": "followed", "stroke": content["stroke"]})
        elif content.get("type") == "stroke":
            try:
                self._stroke_callbacks(_points(buffers), TOOLS[content["tool"]], bool(content["mirror"]))
            finally:
                self.send({"type": "dry", "stroke": content["stroke"]})


def _points(buffers: list[memoryview]) -> np.ndarray:
    return np.frombuffer(buffers[0], dtype="<f4").reshape(-1, 4)
