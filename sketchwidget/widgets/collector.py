"""The collector of drawings: a head to look at, a pad to draw it on, and a file that every drawing goes to."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from ipywidgets import Box, Label, VBox, jslink

from ..database.drawings import VIEWS, Drawing, Weights, append, read_drawings, take_back, weights_of, write_drawings
from ..face import Face, FaceModel
from ..geometry import View
from . import toolbar
from .draft import Draft
from .head_view import HeadView
from .ink import TOOLS
from .keyboard import Keyboard
from .pad import Pad
from .status import Status, counted

SEEN_FROM = {"front": "The head from the front", "left": "The head from its left side"}
TASK = "Draw the head as you see it"
NO_MORE = "There are no more heads"
FRAME = View()  # where each head stands; the page hears of a frame only if it is another


class DrawingCollector(VBox):
    """Shows one head after the other and collects a drawing of each, with the time and the pressure of the pen.

    Each drawing is in the file as soon as it is kept. Opened again with the same file and the same faces, it goes on:
    faces that the file holds a drawing of in this view are passed over, those that were skipped come again.

    Parameters
    ----------
    path : path
        The file, one for each person; see `sketchwidget.database.drawings`. A new one is begun if there is none.
    faces : iterable of Face, optional
        The heads to draw, of one model and with its weights; it may be endless. By default `random_faces` of the
        shipped model: who has the same seed draws the same heads.
    view : str
        From where they are seen: "front", or "left" for the subject's left side.
    seed : int
        Of the random faces.

    Raises
    ------
    ValueError
        If there are no faces, one has no weights, the view is another, or the file holds something else.
    OSError
        If the file cannot be read or written.

    Examples
    --------
    >>> collector = sw.DrawingCollector("drawings-anna.jsonl")  # shown at the end of a notebook's cell
    >>> len(collector.children) > 0
    True
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        faces: Iterable[Face] | None = None,
        view: str = "front",
        seed: int = 0,
    ) -> None:
        if view not in VIEWS:
            raise ValueError(f"a head is drawn in the view {' or '.join(VIEWS)}; given {view!r}")
        self._path, self._view = Path(path), view
        if not self._path.exists():
            write_drawings(self._path, ())
        held = read_drawings(self._path)
        faces = iter(random_faces(FaceModel.load(), seed) if faces is None else faces)
        first = next(faces, None)
        if first is None:
            raise ValueError("there are no faces to draw")
        drawn = Counter(_key(drawing.weights) for drawing in held if drawing.view == view)
        self._faces = _not_yet_drawn(chain([first], faces), drawn)
        self._put_back: list[Face] = []  # faces to come before the others
        self._former: tuple[Face, Draft, Drawing | None] | None = None  # the turn before, and what was kept of it
        self._face = next(self._faces, None)
        self._draft = Draft()
        self._kept = len(held)
        self._pad = Pad(TASK)
        self._head = HeadView(self._face or first, view, turnable=False)
        self._status = Status()
        super().__init__()
        self.children = self._layout()
        self.add_class("sketchwidget-studio")
        self.add_class("sketchwidget-collector")
        self._pad.widget.on_stroke(self._on_stroke)
        self._show()
        self._status.say(self._expected)

    def __repr__(self) -> str:
        return f"DrawingCollector({str(self._path)!r}: {counted(self._kept, 'drawing')} kept)"

    def _layout(self) -> list[Any]:
        tools = toolbar.choice(*TOOLS)
        self._undo, self._redo, self._clear = (toolbar.button(name) for name in ("undo", "redo", "clear"))
        self._skip, self._keep = toolbar.button("skip"), toolbar.button("keep")
        jslink((tools, "index"), (self._pad.widget, "tool"))
        self._undo.on_click(lambda _: self._on_undo())
        self._redo.on_click(lambda _: self._on_redo())
        self._clear.on_click(lambda _: self._on_clear())
        self._skip.on_click(lambda _: self._on_skip())
        self._keep.on_click(lambda _: self._on_keep())

        self._counter = Label().add_class("sketchwidget-mode")
        title = Box([self._counter, toolbar.bar((self._skip, self._keep))]).add_class("sketchwidget-title")
        seen_from = Label(SEEN_FROM[self._view]).add_class("sketchwidget-caption")
        head = VBox([seen_from, self._head.widget]).add_class("sketchwidget-panel")
        edits = (self._undo, self._redo, self._clear)
        drawing = VBox([toolbar.bar((tools,), edits), self._pad.widget]).add_class("sketchwidget-panel")
        desk = Box([head, drawing]).add_class("sketchwidget-desk")
        return [title, desk, self._status, Keyboard(bindings=toolbar.bindings(TOOLS))]

    def _show(self) -> None:
        if self._face is not None:
            self._head.show(self._face, FRAME)
        self._pad.invitation = NO_MORE if self._face is None else TASK
        self._pad.show(self._draft.sketch)
        self._counter.value = f"{counted(self._kept, 'drawing')} kept"
        toolbar.set_useful(self._undo, self._draft.can_undo or self._can_go_back)
        toolbar.set_useful(self._redo, self._draft.can_redo)
        toolbar.set_useful(self._clear, bool(self._draft.strokes))
        toolbar.set_useful(self._keep, self._face is not None and bool(self._draft.strokes))
        toolbar.set_useful(self._skip, self._face is not None)

    @property
    def _expected(self) -> str:
        if self._face is None:
            return f"{NO_MORE}. {counted(self._kept, 'drawing')} kept in {self._path.name}."
        return "Keep the drawing once it is done." if self._draft.strokes else f"{TASK}, or skip it."

    @property
    def _can_go_back(self) -> bool:
        """Whether undo goes back to the turn before: as long as nothing is drawn in this one, not even undone."""
        return self._former is not None and not self._draft.can_undo and not self._draft.can_redo

    # -- what the user does --------------------------------------------------------------------------------------------

    def _on_stroke(self, points: np.ndarray, tool: str, _mirror: bool) -> None:
        with self._status.reporting("This stroke cannot be drawn"):
            if tool == "eraser":
                erased = self._draft.erase(points[:, :2], self._pad.widget.radius)
                self._tell("Erased." if erased else "Nothing to erase there.")
            else:
                self._draft.draw(points)
                self._tell("Stroke drawn.")

    def _on_keep(self) -> None:
        with self._status.reporting("The drawing is not kept, it is still on the pad"):
            if self._face is None or not self._draft.strokes:
                self._tell("" if self._face is None else "Nothing is drawn yet.")
                return
            drawing = Drawing.of(self._face, self._draft.strokes, self._view)
            append(self._path, drawing)
            self._kept += 1
            self._go_on(self._face, drawing)

    def _on_skip(self) -> None:
        if self._face is None:
            self._tell()
        else:
            self._go_on(self._face, None)

    def _go_on(self, face: Face, drawing: Drawing | None) -> None:
        """Show the next head, after one of which a drawing was kept or not."""
        self._former = (face, self._draft, drawing)
        self._draft, self._face = Draft(), None
        with self._status.reporting("The next head cannot be shown"):
            self._face = self._put_back.pop() if self._put_back else next(self._faces, None)
            self._status.say("Skipped." if drawing is None else f"Kept in {self._path.name}.", self._expected)
        self._show()

    def _on_undo(self) -> None:
        with self._status.reporting("Nothing could be undone"):
            if self._former is not None and self._can_go_back:
                self._go_back(*self._former)
            else:
                self._tell("Undone." if self._draft.undo() else "Nothing to undo.")

    def _go_back(self, face: Face, draft: Draft, drawing: Drawing | None) -> None:
        if drawing is not None:
            take_back(self._path, drawing)
            self._kept -= 1
        if self._face is not None:
            self._put_back.append(self._face)
        self._face, self._draft, self._former = face, draft, None
        self._tell("The former head is back." if drawing is None else "The last drawing is back, and kept no more.")

    def _on_redo(self) -> None:
        self._tell("Redone." if self._draft.redo() else "Nothing to redo.")

    def _on_clear(self) -> None:
        self._tell("Cleared; undo brings the drawing back." if self._draft.clear() else "Nothing to clear.")

    def _tell(self, happened: str = "") -> None:
        """Show what is there now, say what happened and what comes next."""
        self._show()
        self._status.say(happened, self._expected)


def random_faces(model: FaceModel, seed: int) -> Iterator[Face]:
    """Faces without end: random ones of the model's identities, each with a random one of its expressions."""
    random, rows = np.random.default_rng(seed), model.bilinear
    while True:
        yield model.face(random.choice(rows.identities), random.choice(rows.expressions))


def _not_yet_drawn(faces: Iterable[Face], drawn: Counter[tuple[bytes, bytes, str]]) -> Iterator[Face]:
    """The faces that are left when as many of each as were drawn before are passed over.

    Raises
    ------
    ValueError
        If a face has no weights.
    """
    for face in faces:
        key = _key(weights_of(face))
        if drawn[key] > 0:
            drawn[key] -= 1
        else:
            yield face


def _key(weights: Weights) -> tuple[bytes, bytes, str]:
    identity, expression, model = weights
    return identity.tobytes(), expression.tobytes(), model
