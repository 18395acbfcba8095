"""Where a shipped file came from: kept in the file's own header."""

from __future__ import annotations

import platform
from importlib.metadata import version

from .. import __version__


def provenance(command: str, packages: tuple[str, ...]) -> dict[str, str]:
    """The command that made a file, and the versions that it ran with."""
    versions = {"sketchwidget": __version__, "python": platform.python_version()}
    versions |= {package: version(package) for package in packages}
    return {"command": command, "versions": ", ".join(f"{name} {number}" for name, number in versions.items())}
