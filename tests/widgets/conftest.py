from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from ipywidgets import Widget

from sketchwidget.sketch import Sketch


class FakeFace:
    """A face of three vertices, as the widgets know faces."""

    faces = np.array([[0, 1, 2]], dtype=np.int32)
    colors = np.full((3, 3), 0.5, dtype=np.float32)

    def __init__(self, width: float = 50.0) -> None:
        self.vertices = np.array([[-width, 0, 0], [width, 0, 0], [0, 100, 0]], dtype=np.float32)

    def sketch(self, wrinkles: bool = True, view: Any = None) -> Sketch:
        return Sketch(()).with_segment("silhouette", view.project(self.vertices))


@pytest.fixture
def face() -> FakeFace:
    return FakeFace()


@pytest.fixture
def sent(monkeypatch: pytest.MonkeyPatch) -> Callable[[Widget], list[tuple[Any, Any]]]:
    """Record what a widget sends to its page."""

    def record(widget: Widget) -> list[tuple[Any, Any]]:
        messages: list[tuple[Any, Any]] = []
        monkeypatch.setattr(widget, "send", lambda content, buffers=None: messages.append((content, buffers)))
        return messages

    return record
