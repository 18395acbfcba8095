"""The recorder of gestures: it names one after the other, and keeps what is drawn."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from ipywidgets import HTML, Box, Label, VBox

from ..gesture import GESTURES
from ..gesture.recordings import FILE, Recording
from ..sketch import Sketch
from ..sketch.pen import from_tablet
from . import toolbar
from .keyboard import Keyboard
from .pad import Pad
from .refining import chart
from .status import Status, counted


class GestureCollector(VBox):
    """Asks for gestures, each as often as the others, and keeps every stroke with its time and pressure.

    A stroke is in the file as soon as it is drawn, and the next gesture is asked for; undo takes the last one back.
    `sketchwidget train gestures --recordings FILE` learns from the file.

    Parameters
    ----------
    path : path
        The file, one for each person; see `sketchwidget.gesture.recordings`. A new one is begun if there is none.
    seed : int
        Of the order in which gestures are asked for.

    Raises
    ------
    ValueError
        If the file holds something else.
    OSError
        If it cannot be read or written.

    Examples
    --------
    >>> collector = sw.GestureCollector("gestures-anna.jsonl")  # shown at the end of a notebook's cell
    >>> collector.asked in sw.GESTURES
    True
    """

    def __init__(self, path: str | os.PathLike[str], seed: int = 0) -> None:
        self._path = Path(path)
        if not self._path.exists():
            FILE.write(self._path, ())
        self._kept = FILE.read(self._path)
        self._random = np.random.default_rng([seed, len(self._kept)])
        self._recent = 0  # strokes of this sitting, which can be taken back
        self._pad, self._status = Pad(), Status()
        super().__init__()
        self._undo, self._skip = toolbar.button("undo"), toolbar.button("pass")
        self._undo.on_click(lambda _: self._on_undo())
        self._skip.on_click(lambda _: self._ask(self._asked))
        self._counter = Label().add_class("sketchwidget-mode")
        examples = HTML(chart()).add_class("sketchwidget-chart")
        title = Box([self._counter, toolbar.bar((self._undo, self._skip))]).add_class("sketchwidget-title")
        panels = [VBox([part]).add_class("sketchwidget-panel") for part in (self._pad.widget, examples)]
        desk = Box(panels).add_class("sketchwidget-desk")
        self.children = [title, desk, self._status, Keyboard(bindings=toolbar.bindings())]
        self.add_class("sketchwidget-studio")
        self._pad.widget.on_stroke(self._on_stroke)
        self._ask()

    def __repr__(self) -> str:
        return f"GestureCollector({str(self._path)!r}: {counted(len(self._kept), 'gesture')} kept)"

    @property
    def asked(self) -> str:
        """The gesture to draw now."""
        return self._asked

    def _ask(self, skipped: str = "") -> None:
        """Ask for one of the gestures that were drawn least, but not at once for what was skipped."""
        drawn = Counter(recording.name for recording in self._kept)
        others = [name for name in GESTURES if name != skipped]
        fewest = min(drawn[name] for name in others)
        self._asked = str(self._random.choice([name for name in others if drawn[name] == fewest]))
        self._show(f"Draw: {self._asked}")

    def _show(self, *sentences: str) -> None:
        self._pad.invitation = f"Draw: {self._asked}"
        self._pad.show(Sketch())
        self._counter.value = f"{counted(len(self._kept), 'gesture')} kept"
        toolbar.set_useful(self._undo, self._recent > 0)
        self._status.say(*sentences)

    def _on_stroke(self, points: Any, _tool: str, _mirror: bool) -> None:
        with self._status.reporting("This stroke is not kept"):
            recording = Recording(from_tablet(points), self._asked)
            FILE.append(self._path, recording)
            self._kept.append(recording)
            self._recent += 1
            self._ask()

    def _on_undo(self) -> None:
        with self._status.reporting("Nothing could be undone"):
            if not self._recent:
                self._status.say("Nothing to undo.", f"Draw: {self._asked}")
                return
            recording = self._kept[-1]
            FILE.take_back(self._path, recording)
            self._kept.pop()
            self._recent -= 1
            self._asked = recording.name or self._asked
            self._show(f"The last stroke is kept no more. Draw again: {self._asked}")
