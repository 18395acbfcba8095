"""What is drawn in a Studio is kept in a file, without being asked: no kernel takes it along when it ends."""

from __future__ import annotations

import os
from contextlib import suppress
from datetime import datetime
from pathlib import Path

from platformdirs import user_state_path

from ..session import Session
from ..session.autosave import Autosave

MOST = 20  # files; older ones are removed


def folder() -> Path:
    """Where the files are: with what programs keep for a user from one run to the next."""
    return user_state_path("sketchwidget") / "sessions"


def files() -> list[Path]:
    """All that are kept, the newest first."""
    return sorted(folder().glob("*.jsonl"), key=_written, reverse=True)


def _written(file: Path) -> float:
    try:
        return file.stat().st_mtime
    except OSError:  # another Studio has removed it
        return 0.0


class Keeping:
    """Writes sessions to files of their own, each from its first change on."""

    def __init__(self) -> None:
        self._session: Session | None = None
        self._autosave: Autosave | None = None

    def keep(self, session: Session) -> str:
        """Write what was done in a session; the file that holds it, empty if none does.

        One that saves itself is left alone: its own file is given. Where nothing can be written, the file holds what
        was done until then, and the next change is another try.
        """
        if session.autosaved is not None:
            return os.fspath(session.autosaved)
        if session is not self._session:
            self._session, self._autosave = session, None
        if self._autosave is None and not session.can_undo:
            return ""
        try:
            if self._autosave is None:
                self._autosave = Autosave(_another())
            self._autosave.write(session.events, session.inference)
        except (OSError, ValueError):
            if self._autosave is None or not os.path.exists(self._autosave.path):
                self._autosave = None
                return ""
        return os.fspath(self._autosave.path)


def _another() -> Path:
    """The path of one more file; the oldest ones make room."""
    folder().mkdir(parents=True, exist_ok=True)
    for old in files()[MOST - 1 :]:
        with suppress(OSError):
            old.unlink()
    return folder() / f"{datetime.now():%Y-%m-%d-%H%M%S-%f}-{os.getpid()}.jsonl"
