"""Builds Binder's environment in a fresh virtual environment and tries it: `python binder/check.py`.

In the end it becomes that of the image for a JupyterHub, whose server must start in it. Nothing of the Python that runs
this is used, and nothing is left behind. What fails or takes too long ends it with a non-zero status.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

BINDER = Path(__file__).resolve().parent
INSTALLING, TRYING = 1500, 300  # seconds at most
INDEX = "--extra-index-url "


def build(folder: Path) -> dict[str, str]:
    """Make the environment in a folder, as Binder does; the variables under which its programs run.

    PyTorch's index is asked for PyTorch alone, as the Makefile does: where it cannot be reached, pip would wait for it
    at each of the other packages.
    """
    venv.create(folder / "venv", with_pip=True)
    binaries = folder / "venv" / "bin"
    where = {**os.environ, "PATH": f"{binaries}{os.pathsep}{os.environ['PATH']}", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    where.pop("PYTHONPATH", None)

    def run(*command: str | Path, check: bool = True) -> int:
        return subprocess.run(command, cwd=BINDER.parent, env=where, timeout=INSTALLING, check=check).returncode

    pip = (binaries / "python", "-m", "pip", "install", "--quiet")
    lines = (BINDER / "requirements.txt").read_text().splitlines()
    index = next(line.removeprefix(INDEX) for line in lines if line.startswith(INDEX))
    torch = next(line for line in lines if line.startswith("torch=="))
    rest = folder / "requirements.txt"
    rest.write_text("\n".join(line for line in lines if not line.startswith(INDEX)))
    if run(*pip, "--no-deps", "--retries", "1", "--timeout", "20", "--index-url", index, torch, check=False):
        print(f"PyTorch's CPU index did not serve {torch}: taking it from the usual index.", flush=True)
    run(*pip, "-r", rest)
    run(BINDER / "postBuild")
    run(binaries / "python", "-m", "pip", "check")
    return where


def make_hubs(folder: Path, where: dict[str, str]) -> None:
    """Add what the image for a JupyterHub has beside Binder's environment, and ask the server that it starts."""
    python = folder / "venv" / "bin" / "python"
    lines = (BINDER / "hub" / "requirements.txt").read_text().splitlines()
    more = folder / "hub.txt"
    more.write_text("\n".join(line for line in lines if not line.startswith("-r ")))
    for command in (
        ("-m", "pip", "install", "--quiet", "-r", more),
        ("-m", "pip", "check"),
        ("-m", "jupyterhub.singleuser", "--version"),
    ):
        subprocess.run([python, *command], cwd=folder, env=where, timeout=INSTALLING, check=True)


def main() -> None:
    """Build, try, and tell how long both took."""
    with tempfile.TemporaryDirectory(prefix="binder-") as name:
        folder = Path(name)
        began = time.monotonic()
        where = build(folder)
        built = time.monotonic()
        for script in ("smoke.py", "page.py"):
            command = [str(folder / "venv" / "bin" / "python"), str(BINDER / script)]
            subprocess.run(command, cwd=folder, env=where, timeout=TRYING, check=True)
        make_hubs(folder, where)
        print(f"Binder's environment works: built in {built - began:.0f} s, tried in {time.monotonic() - built:.0f} s")


if __name__ == "__main__":
    try:
        main()
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
        sys.exit(f"Binder's environment does not work: {error}")
