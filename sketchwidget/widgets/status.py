"""The status line: what just happened and what is expected next; the mode and the timings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from ipywidgets import HBox, Label

from ..sketch import SILHOUETTE, Sketch
from ..sketch.gap import Gap
from .commands import COMMANDS

# What a face is drawn with, as people say it, and the beginnings of the line names that make it up.
PARTS = {"eyes": "eye", "brows": "brow", "nose": "nose", "mouth": "mouth"}
SHOWN_TIMINGS = ("inference", "deformation", "fit", "total")


class Status(HBox):
    """The line at the bottom; errors are a sentence here and nowhere else."""

    def __init__(self) -> None:
        self._message = Label()
        self._figures = Label()
        self._message.add_class("sketchwidget-message")
        self._figures.add_class("sketchwidget-figures")
        super().__init__([self._message, self._figures])
        self.add_class("sketchwidget-status")

    @property
    def message(self) -> str:
        """What the line says."""
        return self._message.value

    def say(self, *sentences: str) -> None:
        """Say what happened and what comes next."""
        self._message.remove_class("sketchwidget-error")
        self._message.value = " ".join(sentence for sentence in sentences if sentence)

    def fail(self, sentence: str) -> None:
        """Say what went wrong."""
        self._message.add_class("sketchwidget-error")
        self._message.value = sentence

    @contextmanager
    def reporting(self, failing: str) -> Iterator[None]:
        """Turn an exception into a sentence: what failed, and why."""
        try:
            yield
        except Exception as error:
            self.log.debug("%s", failing, exc_info=True)
            self.fail(f"{failing}: {sentence(error)}")

    def show_figures(self, mode: str, timings: Mapping[str, float]) -> None:
        """Show the mode and how long its steps took, in milliseconds."""
        figures = [f"{name} {timings[name]:.0f} ms" for name in SHOWN_TIMINGS if name in timings]
        self._figures.value = " · ".join([COMMANDS[mode].label if mode in COMMANDS else mode.capitalize(), *figures])


def expected_next(sketch: Sketch, mode: str = "initial", gap: Gap | None = None) -> str:
    """What to do next, as a sentence: what is still to be drawn by the names that lines were given, or a line anew."""
    if gap is not None:
        where = (
            "from one marked end to the other" if len(gap.ends) == 2 else "from the marked end" if len(gap.ends) else ""
        )
        return f"Now draw the {said(gap.name)} anew {where}".rstrip() + ", or put it back with Escape."
    if mode == "followup":
        return "Erase a piece of a line and draw it anew; other strokes are wrinkles."
    if not len(sketch):
        return "Draw the outline of a face; the head follows every stroke."
    parts = missing(sketch)
    if not parts:
        return "Redraw any line, or turn the head with a drag."
    *most, last = parts
    return f"Still to draw: {', '.join(most)} and {last}, in any order." if most else f"Still to draw: {last}."


def missing(sketch: Sketch) -> list[str]:
    """What of a face is not drawn yet, by the names that lines were given."""
    names = {segment.name for segment in sketch.segments}
    parts = [] if SILHOUETTE in names else ["the outline"]
    return parts + [part for part, word in PARTS.items() if not any(word in name for name in names)]


def said(name: str) -> str:
    """A line's name as people say it; left and right are those of the head."""
    *part, last = name.split("_")
    if last in ("upper", "lower"):
        return f"{last} contour of the {' '.join(part)}"
    return "outline" if name == SILHOUETTE else name.replace("_", " ")


def counted(number: int, thing: str) -> str:
    """So many things, as people say it: none, one, or more of what is named by its singular."""
    return f"{number or 'No'} {thing}{'' if number == 1 else 's'}"


def sentence(error: BaseException) -> str:
    """What an exception says, as a sentence."""
    text = " ".join(str(error).split()) or type(error).__name__
    return text[0].upper() + text[1:] + ("" if text.endswith((".", "!", "?")) else ".")
