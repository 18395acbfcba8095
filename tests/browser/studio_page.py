"""A Studio on a page, as its user has it: drawing with a pointer, pressing keys, looking at pad and head."""

from __future__ import annotations

import base64
import io
import time
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import numpy as np
from jupyter_page import DEADLINE
from PIL import Image
from playwright.sync_api import ElementHandle, Locator, Page

from sketchwidget import View

T = TypeVar("T")
ANGLES = np.linspace(-np.pi / 2, 1.5 * np.pi, 33)
OVAL = np.stack([0.5 + 0.27 * np.cos(ANGLES), 0.5 + 0.39 * np.sin(ANGLES)], axis=1)  # the outline of a face


def until(get: Callable[[], T], holds: Callable[[T], bool] = bool, what: str = "what is expected") -> T:
    """Poll until ``holds(get())``, for as long as two busy cores may take; the value."""
    deadline = time.monotonic() + DEADLINE
    while True:
        value = get()
        if holds(value):
            return value
        if time.monotonic() > deadline:
            raise AssertionError(f"{what} did not come within {DEADLINE:.0f} s; last seen: {str(value)[:300]}")
        time.sleep(0.05)


def settled(get: Callable[[], T], seconds: float = 1.0) -> T:
    """Poll until what was got is something and steady for a while: lines are drawn anew once they have names."""
    last, since = get(), time.monotonic()

    def steady() -> bool:
        nonlocal last, since
        if (value := get()) != last:
            last, since = value, time.monotonic()
        return bool(last) and time.monotonic() - since > seconds

    until(steady, what="a steady value")
    return last


class StudioPage:
    """One Studio of a page, by its number in reading order."""

    def __init__(self, page: Page, number: int = 0) -> None:
        self.page = page
        self.root = page.locator(".sketchwidget-studio").nth(number)
        self.pad = self.root.locator(".sketchwidget-pad")
        self.picture = self.root.locator(".sketchwidget-picture")
        self.head = self.root.locator(".sketchwidget-head")
        self.errors: list[str] = []

    def wait_until_shown(self) -> StudioPage:
        self.root.locator(".sketchwidget-shown").wait_for(timeout=1000 * DEADLINE)
        self.root.locator(".sketchwidget-pad canvas").wait_for(timeout=1000 * DEADLINE)
        self.root.scroll_into_view_if_needed()
        until(lambda: self.serial, what="the first frame")
        until(self.pad_size, lambda size: size[0] >= size[1], "a pad as fine as the screen")
        return self

    # -- what the user does --------------------------------------------------------------------------------------------

    def on_screen(self, point: Iterable[float]) -> tuple[float, float]:
        """A canvas point in the page's coordinates."""
        box = self.pad.bounding_box()
        assert box is not None
        x, y = point
        return box["x"] + x * box["width"], box["y"] + y * box["height"]

    def draw(self, points: Iterable[Iterable[float]], button: str = "left") -> None:
        """Draw with the mouse; canvas coordinates."""
        first, *others = points
        self.page.mouse.move(*self.on_screen(first))
        self.page.mouse.down(button=button)
        for point in others:
            self.page.mouse.move(*self.on_screen(point))
        self.page.mouse.up(button=button)

    def _on_head(self, points: Iterable[Iterable[float]]) -> list[dict[str, float]]:
        """Points of the unit square that the head is seen in, in the page's coordinates."""
        box = self.head.bounding_box()
        assert box is not None
        return [{"x": box["x"] + float(x) * box["width"], "y": box["y"] + float(y) * box["height"]} for x, y in points]

    def draw_on_head(self, points: Iterable[Iterable[float]], button: str = "left") -> None:
        """Draw with the mouse over the head; points of the unit square that it is seen in."""
        first, *others = self._on_head(points)
        self.page.mouse.move(**first)
        self.page.mouse.down(button=button)
        for point in others:
            self.page.mouse.move(**point)
        self.page.mouse.up(button=button)

    def raise_half_of(self, line: np.ndarray) -> None:
        """Draw half of a line of the head, by its vertices, higher in follow-up sketching."""
        before, camera = self.positions(), self.camera()
        scale = 1 / (camera["right"] - camera["left"])
        standing = View(np.eye(3), scale, np.array([-camera["left"], camera["top"]]) * scale)
        half = standing.project(before[line])[: len(line) // 2]
        self.press("e")
        self.draw(half[len(half) // 2 :][:1].tolist())
        until(lambda: self.message, lambda said: said.startswith("Erased."), "the word of the eraser")
        self.press("p")
        self.draw((half - np.array([0, 0.03])).tolist())
        until(lambda: self.message, lambda said: "is drawn anew" in said, "the word of the stroke")
        until(lambda: (self.positions() - before)[line, 1].max(), lambda rise: rise > 4, "a higher line")

    def open_picture(self, name: str, data: bytes) -> None:
        """Open a picture of a face in the tab that is on show."""
        with self.page.expect_file_chooser() as chooser:
            self.click("picture")
        chooser.value.set_files({"name": name, "mimeType": "image/png", "buffer": data})

    def on_picture(self, pixel: Iterable[float]) -> tuple[float, float]:
        """A pixel of the picture in the page's coordinates."""
        box = self.picture.bounding_box()
        view = self.picture.locator("svg").get_attribute("viewBox")
        assert box is not None and view is not None
        left, top, side, _ = map(float, view.split())
        x, y = map(float, pixel)
        return box["x"] + (x - left) / side * box["width"], box["y"] + (y - top) / side * box["height"]

    def takes_clicks_at(self, pixel: Iterable[float]) -> bool:
        """Move the mouse to a pixel of the picture; whether a click there would begin a face."""
        self.page.mouse.move(*self.on_picture(pixel))
        return "sketchwidget-clickable" in (self.picture.get_attribute("class") or "")

    def open_and_click(self, name: str, data: bytes, pixels: np.ndarray) -> str:
        """Open a picture, and click pixels (n, 2) of it, each after the mark of the one before; what was said of it."""
        self.open_picture(name, data)
        opened = until(lambda: self.message, lambda said: said.startswith(f"{name} is open"), "the word of the picture")
        until(lambda: self.takes_clicks_at(pixels[0]), what="a picture that takes clicks")
        until(lambda: len(self.marks()), lambda marks: marks == 0, "a picture without marks")
        for count, pixel in enumerate(pixels, start=1):
            self.page.mouse.click(*self.on_picture(pixel))
            until(lambda: len(self.marks()), lambda marks, count=count: marks >= count, "the mark of the click")
        return opened

    def touch_head(self, points: Iterable[Iterable[float]]) -> None:
        """Draw with a finger over the head, by touches of the browser's own."""
        places = self._on_head(points)
        screen = self.page.context.new_cdp_session(self.page)
        for kind, place in [("touchStart", places[0]), *(("touchMove", place) for place in places[1:])]:
            screen.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [place]})
        screen.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        screen.detach()

    def draw_on_head_with_pen(self, points: Iterable[Iterable[float]]) -> None:
        """Draw with a pen over the head: mouse events of the browser's own that say they are a pen's."""
        places = self._on_head(points)
        screen = self.page.context.new_cdp_session(self.page)
        common = {"button": "left", "pointerType": "pen", "force": 0.4, "clickCount": 1}
        screen.send("Input.dispatchMouseEvent", {"type": "mousePressed", "buttons": 1, **places[0], **common})
        for place in places[1:]:
            screen.send("Input.dispatchMouseEvent", {"type": "mouseMoved", "buttons": 1, **place, **common})
        screen.send("Input.dispatchMouseEvent", {"type": "mouseReleased", "buttons": 0, **places[-1], **common})
        screen.detach()

    def press(self, keys: str) -> None:
        """Press keys with the pointer over the pad."""
        self.pad.hover()
        self.page.keyboard.press(keys)

    def button(self, name: str) -> Locator:
        return self.root.locator(f".sketchwidget-do-{name}")

    def is_useful(self, name: str) -> bool:
        return "sketchwidget-idle" not in (self.button(name).get_attribute("class") or "")

    def click(self, name: str) -> None:
        self.button(name).locator("visible=true").click()

    def is_on(self, name: str) -> bool:
        if name in ("initial", "followup"):
            found = self.root.locator(f".sketchwidget-choice-initial button:nth-of-type({1 + (name == 'followup')})")
        elif name in ("pen", "eraser"):
            found = self.root.locator(f".sketchwidget-choice-pen button:nth-of-type({1 + (name == 'eraser')})")
        else:
            found = self.button(name)
        return "mod-active" in (found.get_attribute("class") or "")

    def start_afresh(self) -> None:
        """An empty pad, the pen, the front view, the toggles as at first: whatever a test before this one left."""
        self.page.bring_to_front()  # downloads go to the page that the user looks at
        self.page.keyboard.up("Control")
        for name, first in {"mirror": False, "ghost": False, "live": True}.items():
            if self.is_on(name) != first:
                self.click(name)
                until(lambda name=name, first=first: self.is_on(name) == first)
        self.press("p")
        self.press("1")
        self.press("i")
        if self.is_useful("clear"):
            self.click("clear")
        until(self.ink_pixels, lambda pixels: pixels == 0, "an empty pad")
        until(lambda: not self.is_useful("clear"))
        until(self.turning, lambda turning: not turning)

    # -- what the user sees --------------------------------------------------------------------------------------------

    @property
    def message(self) -> str:
        return self.root.locator(".sketchwidget-message").inner_text()

    @property
    def figures(self) -> str:
        return self.root.locator(".sketchwidget-figures").inner_text()

    def _handle(self) -> ElementHandle:
        return self.head.element_handle()

    @property
    def serial(self) -> int:
        """The number of the last mesh on screen, 0 before the first."""
        return self._handle().evaluate("head => head.sketchwidget?.serial ?? 0")

    def positions(self) -> np.ndarray:
        """Vertex positions (V, 3) of the mesh on the page."""
        flat = self._handle().evaluate("head => Array.from(head.sketchwidget.geometry.getAttribute('position').array)")
        return np.array(flat, dtype=np.float32).reshape(-1, 3)

    def camera(self) -> dict[str, Any]:
        """Direction of the camera and its frame in millimetres."""
        return self._handle().evaluate(
            """head => {
                const { position, left, right, top, bottom, zoom } = head.sketchwidget.camera;
                return { direction: position.clone().normalize().toArray(), left, right, top, bottom, zoom };
            }"""
        )

    def turning(self) -> bool:
        """Whether the camera moves."""
        before = self.camera()
        time.sleep(0.15)
        return self.camera() != before

    def pad_size(self) -> tuple[int, float]:
        """Pixels of the pad's backing store, and of the screen that it covers."""
        store, screen = self.pad.locator("canvas").evaluate(
            "canvas => [canvas.width, canvas.clientWidth * window.devicePixelRatio]"
        )
        return store, screen

    def ink(self) -> np.ndarray:
        """The pad's pixels (n, n, 4) uint8, the paper transparent."""
        size, data = self.pad.locator("canvas").evaluate(
            """canvas => {
                const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
                let text = '';
                for (let i = 0; i < data.length; i += 9999) text += String.fromCharCode(...data.subarray(i, i + 9999));
                return [canvas.width, btoa(text)];
            }"""
        )
        return np.frombuffer(base64.b64decode(data), dtype=np.uint8).reshape(size, size, 4)

    def marks(self) -> np.ndarray:
        """What is marked on the picture (n, 2), in its pixels."""
        places = self.picture.locator(".sketchwidget-points").evaluate(
            "group => [...group.children].map(dot => [+dot.getAttribute('cx'), +dot.getAttribute('cy')])"
        )
        return np.array(places).reshape(-1, 2)

    def ink_pixels(self) -> int:
        """How many pixels of the pad hold ink."""
        return int((self.ink()[..., 3] > 0).sum())

    def head_pixels(self) -> np.ndarray:
        """A picture (h, w, 3) uint8 of the head as it is on screen."""
        return np.array(Image.open(io.BytesIO(self.head.screenshot())).convert("RGB"))

    def wait_for_frame(self, after: int) -> int:
        """Wait for a mesh later than number ``after`` to be on screen; its number."""
        return until(lambda: self.serial, lambda serial: serial > after, "a new frame")
