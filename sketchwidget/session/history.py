"""The edits of a session that count, and those taken back."""

from __future__ import annotations

from collections import deque

from sketchwidget.gesture.names import LEFT_ARROW, RIGHT_ARROW

from .apply import apply
from .events import Event, Exaggerate, Gesture, Redo, Undo
from .modeller import Modeller
from .state import State

KEPT_STATES = 50


class History:
    """A line of edits from the empty canvas to the present state.

    The last 50 states before the present one are kept whole. An undo further back replays the edits: `apply` is pure,
    so this gives exactly the state that was.

    Parameters
    ----------
    modeller : Modeller
        What the edits are applied with.
    """

    def __init__(self, modeller: Modeller) -> None:
        self._modeller = modeller
        self._done: list[Event] = []
        self._undone: list[Event] = []
        self._set_aside: tuple[State, list[Event]] = State(), []  # a state that was exaggerated, and what was undone
        self._begins = 0  # the edits that are never taken back
        self._states = self._replayed([])

    @property
    def state(self) -> State:
        """The present state."""
        return self._states[-1]

    @property
    def can_undo(self) -> bool:
        """Whether an edit can be taken back."""
        return len(self._done) > self._begins

    @property
    def can_redo(self) -> bool:
        """Whether an edit was taken back, and nothing done since."""
        return bool(self._undone)

    def begin_here(self) -> None:
        """No undo leads further back than to the present state."""
        self._begins = len(self._done)

    def record(self, event: Event, outcome: State | None = None) -> bool:
        """Do what an event says.

        Parameters
        ----------
        event : Event
        outcome : State, optional
            What it gives, where that is known already.

        Returns
        -------
        bool
            Whether it changed anything: an edit without effect, or an undo or redo with nothing to go to, is not kept.

        Raises
        ------
        ValueError
            If the edit cannot be applied; the history is as before.
        """
        match self._meant(event):
            case Undo():
                return self._undo()
            case Redo():
                return self._redo()
        state = outcome or apply(self.state, event, self._modeller)
        if state is self.state:
            return False
        if isinstance(event, Exaggerate):
            if self.state.exaggeration is None:
                self._set_aside = (self.state, self._undone)
            else:  # One after the other is one step, and back at 1 none.
                self._take_back()
                if event.amount == 1.0:
                    self._undone = self._undone_before()
                    return True
        self._done.append(event)
        self._undone = []
        self._states.append(state)
        return True

    def _meant(self, event: Event) -> Event:
        """What an event does to the history: some gestures are an undo or a redo."""
        if not isinstance(event, Gesture):
            return event
        return {LEFT_ARROW: Undo(), RIGHT_ARROW: Redo()}.get(event.name or "", event)

    def _undone_before(self) -> list[Event]:
        """What could be redone before the head of the present state was exaggerated."""
        state, undone = self._set_aside
        return undone if state is self.state else []

    def _undo(self) -> bool:
        if not self.can_undo:
            return False
        self._undone.append(self._take_back())
        return True

    def _take_back(self) -> Event:
        """The last edit, which counts no more."""
        if len(self._states) > 1:
            self._states.pop()
        else:
            self._states = self._replayed(self._done[:-1])
        return self._done.pop()

    def _replayed(self, edits: list[Event]) -> deque[State]:
        """The last states that edits of an empty canvas give."""
        states = deque([State()], maxlen=KEPT_STATES + 1)
        for edit in edits:
            states.append(apply(states[-1], edit, self._modeller))
        return states

    def _redo(self) -> bool:
        if not self._undone:
            return False
        state = apply(self.state, self._undone[-1], self._modeller)
        self._done.append(self._undone.pop())
        self._states.append(state)
        return True
