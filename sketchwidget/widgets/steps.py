"""Edits that can be undone: a line of values, of which one is the present."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

T = TypeVar("T")

KEPT = 50  # steps that can be taken back


class Steps(Generic[T]):
    """The values that something had, one after the other.

    Parameters
    ----------
    first : T
    light : callable, optional
        ``light(values)``: whether so many are light enough to be kept. Of too many, and of more than 50 before the
        present one, the oldest are forgotten.
    """

    def __init__(self, first: T, light: Callable[[Sequence[T]], bool] = lambda _: True) -> None:
        self._states = [first]
        self._now = 0
        self._light = light

    @property
    def present(self) -> T:
        """What it is now."""
        return self._states[self._now]

    @property
    def can_undo(self) -> bool:
        """Whether an edit can be taken back."""
        return self._now > 0

    @property
    def can_redo(self) -> bool:
        """Whether an edit was taken back, and nothing done since."""
        return self._now + 1 < len(self._states)

    def undo(self) -> bool:
        """Take the last edit back; False if there was none."""
        self._now -= (possible := self.can_undo)
        return possible

    def redo(self) -> bool:
        """Do the edit last taken back again; False if there was none, or something was done since."""
        self._now += (possible := self.can_redo)
        return possible

    def go_to(self, value: T) -> None:
        """Let it be something else from now on."""
        self._states[self._now + 1 :] = [value]
        while len(self._states) > KEPT + 1 or (len(self._states) > 1 and not self._light(self._states)):
            del self._states[0]
        self._now = len(self._states) - 1
