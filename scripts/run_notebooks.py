"""Runs notebooks from top to bottom and keeps their outputs, without what says nothing to a reader.

python scripts/run_notebooks.py notebooks/02_bilinear_model.ipynb ...
"""

from __future__ import annotations

import base64
import sys
import tempfile
from io import BytesIO
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from PIL import Image

CELL_TIMEOUT = 1800  # seconds


def run(path: Path) -> None:
    """Run a notebook in a folder of its own and write it back.

    Dropped are progress bars and warnings, times and widgets' states; pictures that come in two formats stay as JPEG,
    others keep 256 colours.
    """
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        NotebookClient(notebook, timeout=CELL_TIMEOUT, resources={"metadata": {"path": folder}}).execute()
    notebook.metadata.pop("widgets", None)
    for cell in notebook.cells:
        cell.metadata = {}
        if cell.cell_type != "code":
            continue
        cell.outputs = [output for output in cell.outputs if output.get("name") != "stderr"]
        for output in cell.outputs:
            if "image/jpeg" in output.get("data", {}):
                output.data.pop("image/png", None)
            if "image/png" in output.get("data", {}):
                output.data["image/png"] = _in_few_colours(output.data["image/png"])
    nbformat.write(notebook, path)


def _in_few_colours(png: str) -> str:
    """A picture in base64 with a palette of 256 colours, if it is smaller so."""
    picture = Image.open(BytesIO(base64.b64decode(png))).convert("RGB")
    smaller = BytesIO()
    picture.quantize(256, dither=Image.Dither.NONE).save(smaller, "PNG", optimize=True)
    encoded = base64.b64encode(smaller.getvalue()).decode()
    return min(png, encoded, key=len)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        run(Path(name))
