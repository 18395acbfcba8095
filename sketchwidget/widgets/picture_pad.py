"""A picture with points on it that can be dragged, and lines between them."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
import traitlets
from ipycanvas import Canvas
from ipywidgets import CallbackDispatcher, Image, widget_serialization
from PIL import Image as Picture

LONGEST = 1536  # pixels of a picture's longer side on the page: finer is more to send than a screen shows
_QUALITY = 88
_ROOM = 1.7  # of the extent of the points: so much of the picture is shown about them
_DECIMALS = 2


class PicturePad(anywidget.AnyWidget):
    """Shows a picture on an ipycanvas, and over it points, by the pixels of the picture, and lines through them.

    Points are dragged at the page's own speed. The message format is in ``picture_pad.js``.
    """

    _esm = Path(__file__).parent / "picture_pad.js"

    canvas = traitlets.Instance(Canvas).tag(sync=True, **widget_serialization)
    size = traitlets.List([0, 0], help="of the picture in pixels, 0 without one").tag(sync=True)
    part = traitlets.List([0, 0, 1], help="left, top and side of the square that is shown, in pixels").tag(sync=True)
    points = traitlets.List(help="[x, y] of each, in pixels").tag(sync=True)
    lines = traitlets.List(help="numbers of the points that each line runs through").tag(sync=True)
    clickable = traitlets.Bool(False, help="whether a click beside the points counts").tag(sync=True)
    invitation = traitlets.Unicode("", help="shown while there is no picture").tag(sync=True)

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(canvas=Canvas(width=1, height=1), **kwargs)
        self._image: Image | None = None
        self._move_callbacks = CallbackDispatcher()
        self._click_callbacks = CallbackDispatcher()
        self.canvas.on_client_ready(self._draw)
        self.on_msg(self._receive)

    def on_move(self, callback: Callable[[int, np.ndarray, bool], None]) -> None:
        """Call ``callback(number, place, done)`` while a point is dragged, and once more when it is let go.

        ``place`` is (2,) pixels. While it is dragged at most 15 times a second, and never before the call before has
        returned.
        """
        self._move_callbacks.register_callback(callback)

    def on_click(self, callback: Callable[[np.ndarray], None]) -> None:
        """Call ``callback(place)`` for each click beside the points, if `clickable`."""
        self._click_callbacks.register_callback(callback)

    def show_picture(self, picture: np.ndarray | None) -> None:
        """Show all of a picture (H, W, 3) uint8, or none."""
        if self._image is not None:
            self._image.close()
        self._image = None if picture is None else _as_widget(picture)
        height, width = (0, 0) if picture is None else picture.shape[:2]
        with self.hold_sync():
            self.size = [width, height]
            self.part = [(width - max(width, height)) / 2, (height - max(width, height)) / 2, max(width, height, 1)]
        self._draw()

    def show_points(self, points: np.ndarray, lines: Sequence[Sequence[int]] = ()) -> None:
        """Show points (n, 2) and the lines between them."""
        with self.hold_sync():
            self.lines = [list(map(int, line)) for line in lines]
            self.points = np.round(np.asarray(points, dtype=float), _DECIMALS).tolist()

    def look_at(self, points: np.ndarray) -> None:
        """Show the part of the picture about some points (n, 2)."""
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        side = min(_ROOM * float((high - low).max()), float(max(self.size)))
        self.part = [*((low + high) / 2 - side / 2).tolist(), side]

    def _draw(self, *_: Any) -> None:
        if self._image is None:
            self.canvas.clear()
            return
        width, height = self.size
        shrink = min(1.0, LONGEST / max(width, height))
        self.canvas.width, self.canvas.height = (max(1, round(shrink * side)) for side in (width, height))
        self.canvas.draw_image(self._image, 0, 0, self.canvas.width, self.canvas.height)

    def _receive(self, _: Any, content: dict[str, Any], buffers: list[memoryview]) -> None:
        if content.get("type") == "click":
            self._click_callbacks(np.array(content["place"], dtype=float))
        elif content.get("type") == "move":
            try:
                place = np.array(content["place"], dtype=float)
                self._move_callbacks(int(content["number"]), place, bool(content["done"]))
            finally:
                self.send({"type": "answer", "move": content["move"]})


def _as_widget(picture: np.ndarray) -> Image:
    shown = Picture.fromarray(picture)
    shown.thumbnail((LONGEST, LONGEST), Picture.Resampling.LANCZOS)
    file = io.BytesIO()
    shown.save(file, "JPEG", quality=_QUALITY)
    return Image(value=file.getvalue(), format="jpeg")
