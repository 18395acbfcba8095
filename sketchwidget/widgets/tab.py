"""What a tab of the Studio is that begins with a picture: it has a head of its own until that is taken over."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

from ipywidgets import DOMWidget

from ..face import Face
from .mesh_stream import Skin

if TYPE_CHECKING:
    from ..avatar import Avatar


class Tab(Protocol):
    """A tab beside those of the session's modes."""

    @property
    def name(self) -> str:
        """Of its command; what is on show in this tab only has the class ``sketchwidget-in-<name>``."""
        ...

    @property
    def bar(self) -> DOMWidget:
        """Its buttons, over the head."""
        ...

    @property
    def face(self) -> Face | None:
        """Its head, exaggerated; None while it has none, and the session's is on show."""
        ...

    @property
    def skin(self) -> Skin | None:
        """The texture of that, if it has one."""
        ...

    @property
    def exported(self) -> Face | Avatar | None:
        """What is exported while it is on show."""
        ...

    @property
    def amount(self) -> float:
        """How much that is exaggerated."""
        ...

    @property
    def timings(self) -> Mapping[str, float]:
        """Milliseconds of what it did last."""
        ...

    @property
    def expected(self) -> str:
        """What to do next, as a sentence."""
        ...

    def enter(self) -> None:
        """Begin to follow the picture: the tab is on show."""
        ...

    def leave(self) -> None:
        """Follow it no more; the head stays."""
        ...

    def exaggerate(self, amount: float) -> None:
        """Show the head exaggerated."""
        ...
