"""The pad: the layers of the drawing on an ipycanvas, under the pen of `Ink`."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable

import numpy as np
from ipycanvas import Canvas, MultiCanvas, hold_canvas

from ..sketch import SILHOUETTE, Sketch, resample
from ..sketch.gap import Gap
from ..sketch.names import COLOURS, kind
from .ink import Ink

LINE_WIDTH = 0.005  # canvas units: 2.4 pixels on a pad of 480
GHOST_COLOUR = "#b0d4cf"  # opaque, as its lines overlap where they meet
OPEN_END_COLOUR, OPEN_END_RADIUS = "#0d8377", 0.009  # theme.css's mark; canvas units
PIECE_POINTS = 24  # of what the eraser takes whole, when it is marked
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
        self._gap: Gap | None = None
        self.canvas.on_client_ready(self._draw)
        self.widget.on_ready(self._draw)
        self.widget.on_cancel(self._draw)
        self.canvas.observe(self._resize, "width")

    def show(self, sketch: Sketch, ghost: Sketch | None = None, gap: Gap | None = None, by_piece: bool = False) -> None:
        """Show a sketch and, faintly under it, another one.

        Of a gap, the open ends are marked, and the erased line is faint. If the eraser takes lines by the piece, and of
        the silhouette what it covers, it marks what it would take: while there is a gap, of the same line only.
        """
        self._sketch, self._ghost, self._gap = sketch, ghost, gap
        self.widget.invitation = "" if len(sketch) or ghost is not None else self.invitation
        erasable = [one for one in sketch.segments if by_piece and (gap is None or one.name == gap.name)]
        self.widget.pieces = [
            _flat(resample(segment.points, PIECE_POINTS)) for segment in erasable if segment.name != SILHOUETTE
        ]
        outlines = [_flat(segment.points) for segment in erasable if segment.name == SILHOUETTE]
        self.widget.outline = outlines[0] if outlines else []
        self._draw()

    def _resize(self, _: object) -> None:
        # A size that comes from a page reaches the canvas, but not its layers.
        for layer in self.canvas._canvases:
            layer.width = layer.height = self.canvas.width
        self._draw()

    def _draw(self) -> None:
        size = self.canvas.width
        ghosts = {GHOST_COLOUR: [] if self._ghost is None else _lines(self._ghost, size)}
        if self._gap is not None:
            ghosts[GHOST_COLOUR].append(self._gap.erased.points * np.float32(size))
        inks = defaultdict(list)
        for segment in self._sketch.segments:
            inks[COLOURS[kind(segment.name)]].append(segment.points * np.float32(size))
        ends = () if self._gap is None else self._gap.ends

        def draw() -> None:
            _stroke(self.canvas[0], ghosts, size)
            _stroke(self.canvas[1], inks, size)
            self.canvas[1].fill_style = OPEN_END_COLOUR
            for x, y in ends:
                self.canvas[1].fill_circle(float(x) * size, float(y) * size, OPEN_END_RADIUS * size)

        _in_one_message(draw)


def _flat(points: np.ndarray) -> list[float]:
    """A polyline (n, 2) as the page takes it."""
    return np.round(points.astype(float), 4).ravel().tolist()


def _lines(sketch: Sketch, size: int) -> list[np.ndarray]:
    return [segment.points * np.float32(size) for segment in sketch.segments]


def _stroke(layer: Canvas, lines: dict[str, list[np.ndarray]], size: int) -> None:
    # In halves: some browsers forget it when a canvas is cleared whole and nothing is drawn after that.
    layer.clear_rect(0, 0, size, size // 2)
    layer.clear_rect(0, size // 2, size, size - size // 2)
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
