from __future__ import annotations

import pytest

from sketchwidget.widgets import toolbar
from sketchwidget.widgets.commands import COMMANDS


def test_no_two_commands_have_one_key():
    keys = [key for command in COMMANDS.values() for key in command.keys]
    assert len(keys) == len(set(keys)) and all(command.keys for command in COMMANDS.values())


@pytest.mark.parametrize("command", COMMANDS.values(), ids=lambda command: command.name)
def test_every_command_has_an_icon_or_words(command):
    assert command.icon or command.label


def test_tooltips_name_the_key():
    assert COMMANDS["redo"].tooltip == "Redo (Ctrl+Shift+Z)"
    assert toolbar.button("undo").tooltip == "Undo (Ctrl+Z)"


def test_keys_click_the_buttons_of_their_commands():
    bindings = toolbar.bindings(("pen", "eraser"))
    assert bindings["ctrl+z"] == ".sketchwidget-do-undo"
    assert bindings["ctrl+y"] == bindings["ctrl+shift+z"] == ".sketchwidget-do-redo"
    assert bindings["e"] == ".sketchwidget-choice-pen button:nth-of-type(2)"
