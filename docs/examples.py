"""Writes the sessions that an empty Studio offers: three of the freehand drawings, stroke by stroke.

python docs/examples.py
"""

from __future__ import annotations

from pathlib import Path

import sketchwidget as sw
from sketchwidget.files import textfile
from sketchwidget.session import Draw, file

DRAWINGS = Path(__file__).parent / "freehand"
EXAMPLES = {"laugh": "08_laughing.json", "scowl": "07_angry.json", "gasp": "06_surprised.json"}


def main() -> None:
    """Write them into the package's data."""
    folder = Path(sw.__file__).parent / "data" / "examples"
    for name, drawing in EXAMPLES.items():
        events = [Draw(segment.points) for segment in sw.Sketch.load(DRAWINGS / drawing).segments]
        textfile.write(folder / f"{name}.jsonl", file.dumps(events))


if __name__ == "__main__":
    main()
