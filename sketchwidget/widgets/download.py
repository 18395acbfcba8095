"""Files from the kernel to the user's disk, through the browser."""

from __future__ import annotations

import gzip
from pathlib import Path

import anywidget

_LEVEL = 4  # of compression: most of the gain, a tenth of a second for the largest file


class Downloads(anywidget.AnyWidget):
    """An invisible widget that hands files to the browser as downloads; the message format is in ``download.js``."""

    _esm = Path(__file__).parent / "download.js"

    def save(self, name: str, data: bytes, mime: str) -> None:
        """Let the browser save ``data`` as a file of this name and type (as ``model/gltf-binary``)."""
        self.send({"type": "file", "name": name, "mime": mime}, [gzip.compress(data, _LEVEL)])
