"""What the tabs of the Studio share that begin with a picture: each has a head of its own until that is taken over."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from ipywidgets import DOMWidget

from ..face import Face, FaceModel
from ..face.texture import Texture
from . import toolbar
from .head_view import HeadView
from .marking import Marked, Marking
from .status import Status

if TYPE_CHECKING:
    from ..avatar import Avatar


class Tab:
    """A tab beside those of the session's modes.

    Parameters
    ----------
    marking : Marking
        The picture and its landmarks.
    head : HeadView
    status : Status
    model_of : callable
        Gives the model whose heads are made.
    show : callable
        ``show(passing)`` when there is another head to show: a passing one while a landmark is dragged.
    take_over : callable
        Called with the head that is to become the session's, and its texture.

    Attributes
    ----------
    name : str
        Of its command; what is on show in this tab only has the class ``sketchwidget-in-<name>``.
    bar : widget
        Its buttons, over the head.
    face : Face or None
        Its head, exaggerated; None while it has none, and the session's is on show.
    skin : Texture or None
        What lies on that.
    amount : float
        How much it is exaggerated beyond what was drawn.
    timings : mapping of str to float
        Milliseconds of what it did last.
    """

    name: str
    bar: DOMWidget

    def __init__(
        self,
        marking: Marking,
        head: HeadView,
        status: Status,
        model_of: Callable[[], FaceModel],
        show: Callable[[bool], None],
        take_over: Callable[[Face, Texture | None], None],
    ) -> None:
        self._marking, self._head, self._status = marking, head, status
        self._model_of, self._show, self._take_over = model_of, show, take_over
        self.face: Face | None = None
        self.skin: Texture | None = None
        self.amount = 1.0
        self.timings: Mapping[str, float] = {}
        self._active = False
        self._take = toolbar.button("take")
        self._take.on_click(lambda _: self._on_take())
        toolbar.set_useful(self._take, False)
        marking.on_change(self._on_marks)

    @property
    def exported(self) -> Face | Avatar | None:
        """What is exported while it is on show: a head that is finished, which can be taken over."""
        return self.face

    @property
    def expected(self) -> str:
        """What to do next, as a sentence."""
        return self._marking.expected

    def enter(self) -> None:
        """Follow the picture from now on: the tab is on show."""
        self._active = True
        self._follow(self._marking.present, done=True)

    def leave(self) -> None:
        """Follow it no more; the head stays."""
        self._active = False

    def exaggerate(self, amount: float) -> None:
        """Show the head exaggerated, where the tab can do that."""

    def _on_marks(self, marked: Marked, done: bool) -> None:
        if self._active:
            self._follow(marked, done)

    def _follow(self, marked: Marked, done: bool) -> None:
        """Make the head of a picture and its landmarks; they are still dragged unless it is done."""
        raise NotImplementedError

    def _on_take(self) -> None:
        if self.exported is None or self.face is None:
            self._status.say("There is no head to take over yet.", self.expected)
        else:
            self._take_over(self.face, self.skin)
