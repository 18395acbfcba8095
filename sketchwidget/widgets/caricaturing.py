"""The Caricature tab of the Studio: the landmarks of a picture as an exaggerated head (Alive Caricature)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from ipywidgets import HBox

from ..caricature import CaricatureFit, exaggerate, fit
from ..caricature.fitting import ITERATIONS
from ..face import Face, FaceModel
from . import toolbar
from .head_view import HeadView
from .marking import Marked, Marking
from .status import Status, sentence
from .worker import Report, Worker

FITTING = "The head is fitted to the landmarks …"
FITTED = "The head meets the landmarks, {:.1f} % of the eyes' distance off."


@dataclass(frozen=True, eq=False)
class _Fitted:
    """What a job gave."""

    fit: CaricatureFit
    marked: Marked
    done: bool
    milliseconds: float


class Caricaturing:
    """A head that follows the landmarks of a picture.

    While a landmark is dragged, a quick step follows it; once it is let go, the head is fitted anew. Fits are done
    beside the page.

    Parameters
    ----------
    marking : Marking
        The picture and its landmarks.
    head : HeadView
    status : Status
    model_of : callable
        Gives the model whose heads are fitted.
    show : callable
        ``show(passing)`` when there is another head to show: a passing one while a landmark is dragged.
    take_over : callable
        Called with the head that is to become the session's.

    Attributes
    ----------
    bar : widget
    face : Face or None
        The head for the landmarks at present, exaggerated.
    amount : float
        How much it is exaggerated beyond what was drawn.
    timings : dict of str to float
        Milliseconds of the last fit.
    """

    name = "caricature"
    skin = None  # of clay

    def __init__(
        self,
        marking: Marking,
        head: HeadView,
        status: Status,
        model_of: Callable[[], FaceModel],
        show: Callable[[bool], None],
        take_over: Callable[[Face], None],
    ) -> None:
        self._marking, self._head, self._status = marking, head, status
        self._model_of, self._show, self._take_over = model_of, show, take_over
        self.face: Face | None = None
        self.amount = 1.0
        self.timings: dict[str, float] = {}
        self._active = False
        self._fitted: _Fitted | None = None
        self._worker = Worker(self._on_fit, self._on_failure)
        pose, self._take = toolbar.button("pose"), toolbar.button("take")
        pose.on_click(lambda _: self.look())
        self._take.on_click(lambda _: self._on_take())
        toolbar.set_useful(self._take, False)
        views = toolbar.bar((pose,)).add_class("sketchwidget-views")
        self.bar = HBox([views, toolbar.bar((self._take,))])
        marking.on_change(self._on_marks)

    @property
    def exported(self) -> Face | None:
        """What is exported while the tab is on show."""
        return self.face

    @property
    def expected(self) -> str:
        """What to do next, as a sentence."""
        return self._marking.expected

    def enter(self) -> None:
        """Follow the landmarks from now on."""
        self._active = True
        self._follow(self._marking.present, done=True)
        self.look()

    def leave(self) -> None:
        """Follow them no more; the head stays."""
        self._active = False

    def exaggerate(self, amount: float) -> None:
        """Exaggerate the head beyond the drawing, or below it."""
        self.amount = amount
        self._renew(passing=False)

    def look(self) -> None:
        """Turn the head as the picture shows it."""
        if self._fitted is not None:
            self._head.look_from(self._fitted.fit.rotation[2])

    def _on_marks(self, marked: Marked, done: bool) -> None:
        if self._active:
            self._follow(marked, done)

    def _follow(self, marked: Marked, done: bool) -> None:
        landmarks, fitted = marked.landmarks, self._fitted
        if landmarks is None:
            self._worker.drop()
            self._fitted = None
            self._renew(passing=False)
            return
        if fitted is not None and fitted.done and fitted.marked is marked:
            self._worker.drop()
            self._renew(passing=False)
            return
        if done:
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
        another = self._fitted is None or self._fitted.marked.picture is not fitted.marked.picture
        self._fitted, self.timings = fitted, {"fit": fitted.milliseconds}
        if another:
            self.amount = 1.0
            if self._active:
                self.look()
        self._renew(passing=not fitted.done)
        if fitted.done and self._active:
            eyes = np.linalg.norm(fitted.fit.landmarks[36] - fitted.fit.landmarks[45])
            self._status.say(FITTED.format(100 * fitted.fit.rmse / eyes), self.expected)

    def _on_failure(self, error: Exception) -> None:
        self._status.fail(f"There is no head for these landmarks, the one before is kept: {sentence(error)}")

    def _renew(self, passing: bool) -> None:
        self.face = None if self._fitted is None else exaggerate(self._fitted.fit.face, self.amount)
        toolbar.set_useful(self._take, self.face is not None)
        if self._active:
            self._show(passing)

    def _on_take(self) -> None:
        if self.face is None:
            self._status.say("There is no head to take over yet.", self.expected)
        else:
            self._take_over(self.face)
