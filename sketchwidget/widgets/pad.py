"""The pad: the layers of the drawing on an ipycanvas, under the pen of `Ink`."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable

import numpy as np
from ipycanvas import Canvas, MultiCanvas, hold_canvas

from ..sketch import Sketch
from ..sketch.names import COLOURS, kind
from .ink import Ink

LINE_WIDTH = 0.005  # canvas units: 2.4 pixels on a pad of 480
GHOST_COLOUR = "#b0d4cf"  # opaque, as its lines overlap where they meet
START_SIZE = 256  # pixels, until a page says how many it shows
INVITATION = "Draw the outline of a face"


class Pad:
    """Shows a sketch, line by line in the colour of its kind, over the ghost of another.

    What is shown is drawn again whenever a page connects, or shows the pad at another size.

    Parameters
    ----------
    invitation : str

    Attributes
    ----------
    invitation : str
        What the empty pad says from the next `show` on.
    widget : Ink
        What to put on the page; its strokes are what the user draws.
    """

    def __init__(self, invitation: str = INVITATION) -> None:
        self.invitation = invitation
        self.canvas = MultiCanvas(3, width=START_SIZE, height=START_SIZE)
        self.widget = Ink(canvas=self.canvas, colour=COLOURS["unnamed"], line_width=LINE_WIDTH, invitation=invitation)
        self._sketch = Sketch(())
        self._ghost: Sketch | None = None
        self.canvas.on_client_ready(self._draw)
        self.widget.on_ready(self._draw)
        self.widget.on_cancel(self._draw)
        self.canvas.observe(self._resize, "width")

    def show(self, sketch: Sketch, ghost: Sketch | None = None) -> None:
        """Show a sketch and, faintly under it, another one."""
        self._sketch, self._ghost = sketch, ghost
        self.widget.invitation = "" if len(sketch) or ghost is not None else self.invitation
        self._draw()

    def _resize(self, _: object) -> None:
        # A size that comes from a page reaches the canvas, but not its layers.
        for layer in self.canvas._canvases:
            layer.width = layer.height = self.canvas.width
        self._draw()

    def _draw(self) -> None:
        size = self.canvas.width
        ghosts = {GHOST_COLOUR: _lines(self._ghost, size)} if self._ghost is not None else {}
        inks = defaultdict(list)
        for segment in self._sketch.segments:
            inks[COLOURS[kind(segment.name)]].append(segment.points * np.float32(size))
        _in_one_message(lambda: (_stroke(self.canvas[0], ghosts, size), _stroke(self.canvas[1], inks, size)))


def _lines(sketch: Sketch, size: int) -> list[np.ndarray]:
    return [segment.points * np.float32(size) for segment in sketch.segments]


def _stroke(layer: Canvas, lines: dict[str, list[np.ndarray]], size: int) -> None:
    layer.clear()
    layer.line_cap = layer.line_join = "round"
    layer.line_width = LINE_WIDTH * size
    for colour, points in lines.items():
        layer.stroke_style = layer.fill_style = colour
        paths = [one for one in points if len(one) > 1]
        dots = [one[0] for one in points if len(one) == 1]
        if paths:
            layer.stroke_line_segments(paths)
        for x, y in dots:
            layer.fill_circle(float(x), float(y), LINE_WIDTH * size / 2)


def _in_one_message(draw: Callable[[], object]) -> None:
    """Send the commands of ``draw`` together, also if it raises: ipycanvas would hold its commands for ever after."""
    failure: Exception | None = None
    with hold_canvas():
        try:
            draw()
        except Exception as error:
            failure = error
    if failure is not None:
        raise failure
