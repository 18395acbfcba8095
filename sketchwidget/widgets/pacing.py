"""Pads whose strokes are sent while they are drawn share how often: ``pacing.js``."""

from __future__ import annotations

from pathlib import Path


def paced(module: str) -> str:
    """The text of a pad's module, after that of ``pacing.js``: a page loads one text for each widget."""
    here = Path(__file__).parent
    return "".join((here / name).read_text(encoding="utf-8") for name in ("pacing.js", module))
