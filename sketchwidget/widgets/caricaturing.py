"""The Caricature tab of the Studio: the landmarks of a picture as an exaggerated head (Alive Caricature)."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from ipywidgets import HBox

from ..caricature import CaricatureFit, exaggerate, fit
from ..caricature.fitting import ITERATIONS
from ..portrait.landmarks import OUTER_EYE_CORNERS
from . import toolbar
from .marking import Marked
from .status import sentence
from .tab import Tab
from .worker import Report, Worker

FITTING = "The head is fitted to the landmarks …"
FITTED = "The head fits the landmarks: they are {:.1f} % of the distance between the eyes off on average."


@dataclass(frozen=True, eq=False)
class _Fitted:
    """What a job gave."""

    fit: CaricatureFit
    marked: Marked
    done: bool
    milliseconds: float


class Caricaturing(Tab):
    """A head that follows the landmarks of a picture.

    While a landmark is dragged, a quick step follows it; once it is let go, the head is fitted anew. Fits are done
    beside the page.
    """

    name = "caricature"

    def __init__(self, *shared: Any) -> None:
        super().__init__(*shared)
        self._fitted: _Fitted | None = None
        self._fitting = False
        self._worker = Worker(self._on_fit, self._on_failure)
        pose = toolbar.button("pose")
        pose.on_click(lambda _: self.look())
        views = toolbar.bar((pose,)).add_class("sketchwidget-views")
        self.bar = HBox([views, toolbar.bar((self._take,))])

    @property
    def expected(self) -> str:
        """What to do next, as a sentence; while the head of a picture is awaited, that it is."""
        return FITTING if self._fitting else super().expected

    def enter(self) -> None:
        """Follow the landmarks from now on, and turn the head as the picture shows it."""
        super().enter()
        self.look()

    def exaggerate(self, amount: float) -> None:
        """Exaggerate the head beyond the drawing, or below it."""
        self.amount = amount
        self._renew(passing=False)

    def look(self) -> None:
        """Turn the head as the picture shows it."""
        if self._fitted is not None:
            self._head.look_from(self._fitted.fit.rotation[2])

    def _follow(self, marked: Marked, done: bool) -> None:
        landmarks, fitted = marked.landmarks, self._fitted
        if landmarks is None:
            self._fitting = False
            self._worker.drop()
            self._fitted = None
            self._renew(passing=False)
            return
        if fitted is not None and fitted.done and fitted.marked is marked:
            self._fitting = False
            self._worker.drop()
            self._renew(passing=False)
            return
        if done:
            self._fitting = True
            self._status.say(FITTING)
            start, model = None, self._model_of()
        elif fitted is None:
            return
        else:
            start, model = fitted.fit, fitted.fit.model

        def job(_: Report) -> _Fitted:
            began = perf_counter()
            found = fit(landmarks, model=model, start=start, iterations=1 if start else ITERATIONS)
            return _Fitted(found, marked, done, 1e3 * (perf_counter() - began))

        self._worker.do(job)

    def _on_fit(self, fitted: _Fitted) -> None:
        self._fitting = self._worker.waits
        another = self._fitted is None or self._fitted.marked.picture is not fitted.marked.picture
        self._fitted, self.timings = fitted, {"fit": fitted.milliseconds}
        if another:
            self.amount = 1.0
            if self._active:
                self.look()
        self._renew(passing=not fitted.done)
        if fitted.done and self._active:
            eyes = np.linalg.norm(np.subtract(*fitted.fit.landmarks[list(OUTER_EYE_CORNERS)]))
            self._status.say(FITTED.format(100 * fitted.fit.rmse / eyes), self.expected)

    def _on_failure(self, error: Exception) -> None:
        self._fitting = self._worker.waits
        if self._active:  # else it fails again, and is told, once the tab is on show
            self._status.fail(f"There is no head for these landmarks, the one before is kept: {sentence(error)}")

    def _renew(self, passing: bool) -> None:
        self.face = None if self._fitted is None else exaggerate(self._fitted.fit.face, self.amount)
        toolbar.set_useful(self._take, self.face is not None)
        if self._active:
            self._show(passing)
