"""The page's end of the kernel: a Studio whose kernel is gone says so."""

from __future__ import annotations

from pathlib import Path

import anywidget
import traitlets


class Connection(anywidget.AnyWidget):
    """A line that appears in place of the Studio's status when the kernel has ended or was restarted."""

    _esm = Path(__file__).parent / "connection.js"

    kept = traitlets.Unicode("", help="the file that holds what was drawn").tag(sync=True)
