"""The Studio's files: sessions saved and loaded, heads exported."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..face import Face
from ..face.texture import TexturedFace
from ..files.textfile import as_text
from ..session import Session
from . import toolbar
from .download import Downloads
from .status import Status

if TYPE_CHECKING:
    from ..avatar import Avatar

EXPORTS = {"obj": "model/obj", "glb": "model/gltf-binary"}
SESSION_NAME, SESSION_TYPE = "drawing.jsonl", "application/jsonl"


class Files:
    """Buttons that save, load and export.

    Parameters
    ----------
    session_of : callable
        Gives the session on show.
    show : callable
        Shows another session in its place.
    face_of : callable
        Gives the head on show.
    status : Status

    Attributes
    ----------
    groups : tuple of tuples of widgets
        The buttons, related ones together.
    downloads : Downloads
    """

    def __init__(
        self,
        session_of: Callable[[], Session],
        show: Callable[[Session], None],
        face_of: Callable[[], Face | TexturedFace | Avatar],
        status: Status,
    ) -> None:
        self._session_of, self._show_session, self._face_of, self._status = session_of, show, face_of, status
        self._loaded: tuple[Session, Session, int] | None = None  # former, loaded, and the latter's number of events
        self.downloads = Downloads()
        save, load = toolbar.button("save"), toolbar.picker("load", ".jsonl,.json")
        exports = tuple(toolbar.button(name) for name in EXPORTS)
        save.on_click(lambda _: self._on_save())
        load.observe(self._on_load, "value")
        for name, button in zip(EXPORTS, exports, strict=True):
            button.on_click(lambda _, name=name: self._on_export(name))
        self.groups = ((save, load), exports)

    @property
    def just_loaded(self) -> bool:
        """Whether the session on show is as it was loaded from a file, so that undo undoes the loading."""
        if self._loaded is None:
            return False
        _, loaded, events = self._loaded
        return self._session_of() is loaded and len(loaded.events) == events

    def undo_loading(self) -> bool:
        """Show the session from before the loading, if that is what undo would undo."""
        if self._loaded is None or not self.just_loaded:
            return False
        self._show_session(self._loaded[0])
        self._status.say("The drawing from before the loading is back.")
        return True

    def load(self, name: str, content: bytes, then: Callable[[], str] = str) -> None:
        """Show the session of a file's content; what is wrong with it is told. ``then()`` is said after that."""
        with self._status.reporting(f"{name} was not loaded, the drawing is kept"):
            session = self._session_of()
            loaded = session.another(as_text(content))
            self._loaded = (session, loaded, len(loaded.events))
            self._show_session(loaded)
            self._status.say(f"{name} is loaded; undo brings the former drawing back.", then())

    def _on_export(self, suffix: str) -> None:
        with self._status.reporting("The head could not be exported"):
            self.downloads.save(f"head.{suffix}", self._face_of().to_bytes(suffix), EXPORTS[suffix])
            self._status.say(f"The head is exported as head.{suffix}.")

    def _on_save(self) -> None:
        with self._status.reporting("The session could not be saved"):
            self.downloads.save(SESSION_NAME, self._session_of().dumps().encode(), SESSION_TYPE)
            self._status.say(f"The session is saved as {SESSION_NAME}; load it to go on from here.")

    def _on_load(self, change: dict[str, Any]) -> None:
        if not change["new"]:
            return
        file = change["new"][0]
        change["owner"].value = ()  # so that the same file can be picked again
        self.load(file.name, bytes(file.content))
