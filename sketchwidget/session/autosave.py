"""A session's file, kept up to date while it goes on."""

from __future__ import annotations

import os
from collections.abc import Sequence

from sketchwidget.files import textfile

from . import file
from .events import Event


class Autosave:
    """A file that holds a session's events, however the kernel ends.

    It is written whole each time, in one step: there is no moment at which it cannot be read.

    Parameters
    ----------
    path : path
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = path
        self._written: list[tuple[Event, str]] = []  # events and their lines, so that each is made once

    def write(self, events: Sequence[Event], inference: bool = True) -> None:
        """Write these events, of a session that infers or not, in place of the former ones.

        Raises
        ------
        OSError
            If the file cannot be written; it stays as it was.
        ValueError
            If it would be larger than can be read back.
        """
        kept = 0
        while kept < min(len(events), len(self._written)) and self._written[kept][0] is events[kept]:
            kept += 1
        self._written[kept:] = [(event, file.line(event)) for event in events[kept:]]
        textfile.write(self.path, file.joined([line for _, line in self._written], inference))
