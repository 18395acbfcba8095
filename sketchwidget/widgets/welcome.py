"""An empty Studio's invitation: drawings to begin with, and what there is beyond the first of them."""

from __future__ import annotations

from collections.abc import Callable

from ipywidgets import Box, Button, Label

from ..files.shipped import shipped
from ..session import Erase, Gesture, Mode, Session
from .commands import COMMANDS
from .status import missing

EXAMPLES = ("laugh", "scowl", "gasp")  # files of the package, which docs/examples.py writes


class Welcome(Box):
    """Buttons that load a drawing, for who does not know what to draw yet.

    Parameters
    ----------
    load : callable
        ``load(name, text)`` shows the session of a text.
    """

    def __init__(self, load: Callable[[str, str], object]) -> None:
        label = Label("or begin with")
        buttons = []
        for name in EXAMPLES:
            said = f"a {name}"
            button = Button(description=said, tooltip=f"Load a drawing: {said}")
            button.on_click(lambda _, name=name, said=said: load(said.capitalize(), example(name)))
            buttons.append(button)
        super().__init__([label, *buttons])
        self.add_class("sketchwidget-welcome")

    def show(self, wanted: bool) -> None:
        """Show them, or not."""
        self.layout.display = None if wanted else "none"


def example(name: str) -> str:
    """The session's text of an example by its name."""
    return shipped(f"examples/{name}.jsonl").read_text(encoding="utf-8")


def beyond(session: Session) -> str:
    """What comes after the mode that a session is in, as a sentence, until it has been there once."""
    entered = {event.mode for event in session.events if isinstance(event, Mode)}
    done = {type(event) for event in session.events}
    if session.mode == "initial" and len(session.sketch) and not missing(session.sketch) and "followup" not in entered:
        return f"{_key('followup')} edits the head's own lines."
    if session.mode == "followup" and session.gap is None and Erase in done and "refine" not in entered:
        return f"{_key('refine')} shapes the head by gestures."
    if session.mode == "refine" and Gesture in done:
        return f"{_key('save')} saves the session, {_key('glb')} exports the head."
    return ""


def _key(name: str) -> str:
    """The key of a command as people write it."""
    return COMMANDS[name].keys[0].upper()
