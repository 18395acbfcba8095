"""Buttons for the Studio's commands: icons of one size, each with a tooltip that names its key."""

from __future__ import annotations

from ipywidgets import Button, FileUpload, HBox, ToggleButton, ToggleButtons, Widget

from .commands import COMMANDS, css_class


def button(name: str) -> Button:
    """A button that does a command once."""
    command = COMMANDS[name]
    made = Button(icon=command.icon, description=command.label, tooltip=command.tooltip)
    made.add_class(css_class(name))
    return made


def toggle(name: str) -> ToggleButton:
    """A button that is on or off."""
    command = COMMANDS[name]
    made = ToggleButton(icon=command.icon, description=command.label, tooltip=command.tooltip)
    made.add_class(css_class(name))
    return made


def choice(*names: str) -> ToggleButtons:
    """Buttons of which one is on; ``value`` says which. The browser switches them without asking the kernel."""
    commands = [COMMANDS[name] for name in names]
    made = ToggleButtons(
        options=_options(names),
        icons=[command.icon for command in commands if command.icon],
        tooltips=[command.tooltip for command in commands],
    )
    made.add_class(f"sketchwidget-choice-{names[0]}")
    return made


def extend(made: ToggleButtons, names: tuple[str, ...], added: tuple[str, ...]) -> None:
    """Give a choice of commands more buttons, which have a text each; what is chosen stays if it is still there."""
    chosen, all_names = made.value, (*names, *added)
    made.tooltips = [*(COMMANDS[name].tooltip for name in names), *added]
    made.options = (*_options(names), *((name, name) for name in added))
    made.value = chosen if chosen in all_names else names[0]


def _options(names: tuple[str, ...]) -> tuple[tuple[str, str], ...]:
    return tuple((COMMANDS[name].label or name, name) for name in names)


def picker(name: str, accept: str) -> FileUpload:
    """A button that lets the user pick a file; its ``value`` holds the content."""
    command = COMMANDS[name]
    made = FileUpload(icon=command.icon, description="", tooltip=command.tooltip, accept=accept)
    made.add_class(css_class(name))
    return made


def set_useful(made: Button, useful: bool) -> None:
    """Show whether a button would do something now.

    It can be pressed all the same: were it disabled, the second of two quick keys would be lost while the kernel is at
    work on the first.
    """
    (made.remove_class if useful else made.add_class)("sketchwidget-idle")


def bar(*groups: tuple[Widget, ...]) -> HBox:
    """Buttons in a row, related ones together."""
    rows = []
    for group in groups:
        rows.append(HBox(group))
        rows[-1].add_class("sketchwidget-group")
    made = HBox(rows)
    made.add_class("sketchwidget-bar")
    return made


def bindings(*choices: tuple[str, ...]) -> dict[str, str]:
    """Each key of each command, and the CSS selector of the button that it clicks.

    ``choices`` are the names that were given to `choice`; all other commands have a button of their own.
    """
    selectors = {name: f".{css_class(name)}" for name in COMMANDS}
    for names in choices:
        for number, name in enumerate(names, start=1):
            selectors[name] = f".sketchwidget-choice-{names[0]} button:nth-of-type({number})"
    return {key: selectors[command.name] for command in COMMANDS.values() for key in command.keys}
