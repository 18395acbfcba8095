"""Keys for the Studio that has the pointer or the focus; and the Studio's style sheet, which comes with them."""

from __future__ import annotations

from pathlib import Path

import anywidget
import traitlets

_HERE = Path(__file__).parent


class Keyboard(anywidget.AnyWidget):
    """An invisible widget: a key pressed over the Studio clicks the button of its command.

    Parameters
    ----------
    bindings : dict of str to str
        Key, as in `Command.keys`, to the CSS selector of the button within the Studio.
    """

    _esm = _HERE / "keyboard.js"
    _css = _HERE / "theme.css"

    bindings = traitlets.Dict().tag(sync=True)
