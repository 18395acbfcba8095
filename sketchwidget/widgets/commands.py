"""What the Studio and the collectors can be told to do: one table of commands, each with its icon, key and tooltip."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Command:
    """A command.

    Parameters
    ----------
    name : str
        What the code calls it; its button carries the CSS class ``sketchwidget-do-<name>``.
    text : str
        What the tooltip says it does.
    keys : tuple of str
        The keys that do it: lower case, modifiers first (``"ctrl+shift+z"``; ``ctrl`` is also the Mac's command key).
        The tooltip names the first.
    icon : str
        A FontAwesome 5 name, the set that both JupyterLab and Voila ship.
    label : str
        What the button says beside the icon, or instead of it.
    """

    name: str
    text: str
    keys: tuple[str, ...]
    icon: str = ""
    label: str = ""

    @property
    def tooltip(self) -> str:
        """The text and the key, as ``Undo (Ctrl+Z)``."""
        key = "+".join(part.capitalize() for part in self.keys[0].split("+"))
        return f"{self.text} ({key})"


COMMANDS = {
    command.name: command
    for command in (
        Command("pen", "Pen", ("p",), "pen"),
        Command("eraser", "Eraser", ("e",), "eraser"),
        Command("undo", "Undo", ("ctrl+z",), "undo"),
        Command("redo", "Redo", ("ctrl+shift+z", "ctrl+y"), "redo"),
        Command("clear", "Clear the drawing", ("delete",), "trash"),
        Command("mirror", "Mirror drawing: each stroke on both sides", ("m",), "arrows-alt-h"),
        Command("ghost", "Ghost: the head's own lines under the ink", ("g",), "ghost"),
        Command("live", "Live: the head follows while you draw", ("v",), "bolt"),
        Command("cancel", "Put back what was erased", ("escape",), "times"),
        Command("template", "Start from the lines of the template", ("t",), "user"),
        Command("initial", "Initial sketching: draw freely", ("i",), label="Initial"),
        Command("followup", "Follow-up sketching: edit the lines of the head", ("f",), label="Follow-up"),
        Command("refine", "Refinement: shape the head by gestures", ("r",), label="Refine"),
        Command("caricature", "Caricature: a head from the landmarks of a picture", ("c",), label="Caricature"),
        Command("portrait", "Portrait: an animatable head from a picture", ("x",), label="Portrait"),
        Command("another", "The next face of the picture, from the left", ("w",), "user-friends", "another face"),
        Command("models", "Fetch what finds faces: MediaPipe's models", ("ctrl+m",), "download", "find faces"),
        Command("picture", "Open a picture of a face", ("ctrl+o",), "image"),
        Command("pose", "See the head as the picture shows it", ("5",), label="picture"),
        Command("take", "Take the head over, to edit its lines and refine it", ("ctrl+enter",), "check", "take over"),
        Command("gesture", "Gesture: draw one on the head", ("d",), "pen-fancy"),
        Command("brush", "Brush: mark handles", ("h",), "paint-brush"),
        Command("unbrush", "Unmark handles", ("u",), "eraser"),
        Command("orbit", "Turn the head; so does the right button, or Alt", ("a",), "sync-alt"),
        Command("chart", "The gestures and what they do", ("?",), "question"),
        Command("front", "See the head from the front", ("1",), label="front"),
        Command("left", "See the subject's left side", ("2",), label="left"),
        Command("right", "See the subject's right side", ("3",), label="right"),
        Command("three-quarter", "See the head in three-quarter view", ("4",), label="¾"),
        Command("save", "Save the session to a file", ("s",), "save"),
        Command("load", "Load a session from a file", ("l",), "folder-open"),
        Command("obj", "Export the head as OBJ", ("o",), "download", "OBJ"),
        Command("glb", "Export the head as GLB", ("b",), "download", "GLB"),
        Command("keep", "Keep the drawing and go on to the next head", ("k",), "check", "keep and next"),
        Command("skip", "Go on to the next head without a drawing", ("n",), "forward", "skip"),
        Command("pass", "Ask for another gesture", ("j",), "forward", "skip"),
    )
}


def css_class(name: str) -> str:
    """The CSS class of a command's button."""
    return f"sketchwidget-do-{name}"
