"""Where the files are that come with the package."""

from importlib.resources import files
from pathlib import Path


def shipped(name: str) -> Path:
    """The path of a file of `sketchwidget/data` by its name, with its folder if it is in one."""
    return Path(str(files("sketchwidget") / "data" / name))
