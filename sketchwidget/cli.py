"""The `sketchwidget` command.

A command imports what it runs when it runs, so that `sketchwidget --help` answers at once. A group of commands is a
`typer.Typer` of its own, imported here and added by `main.add_typer(group, name=...)`; its module must be as light.
What a user can mend ends in `fail`: a ValueError or OSError of any command, or a package that is missing. A command
that goes on where it was stopped is a `Resumable`, and says so when that happens.
"""

from __future__ import annotations

import json
import os
import secrets
import socket
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, NoReturn
from urllib.parse import quote

import typer
from typer.core import TyperGroup

from sketchwidget import __version__
from sketchwidget.database.commands import Resumable, database, drawings
from sketchwidget.training.commands import evaluate, train


class _Commands(TyperGroup):
    def invoke(self, ctx: Any) -> Any:
        """Run a command; what a user can mend ends in a message and a non-zero status."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as stop:
            typer.echo(f"sketchwidget: {'; '.join(['stopped', *stop.args])}", err=True)
            raise typer.Exit(130) from None
        except ModuleNotFoundError as error:
            fail(f"{error.name} is missing: pip install 'sketchwidget[database]'")
        except (OSError, ValueError) as error:
            fail(str(error))


main = typer.Typer(
    cls=_Commands,
    help="Draw a face in a notebook, and a 3D head follows your pen.",
    no_args_is_help=True,
    add_completion=False,
)
main.add_typer(train, name="train")
main.add_typer(drawings, name="drawings")
main.command(cls=Resumable)(database)
main.command()(evaluate)


def fail(message: str) -> NoReturn:
    """End the command with a message on the error stream and status 1."""
    typer.echo(f"sketchwidget: {message}", err=True)
    raise typer.Exit(1)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"sketchwidget {__version__}")
        raise typer.Exit


@main.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version and leave.")
    ] = False,
) -> None:
    """Take the options that stand before a command."""


@main.command()
def studio(
    host: Annotated[str, typer.Option(help="Address to listen on; 0.0.0.0 is every network.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port to listen on.")] = 8888,
    app: Annotated[bool, typer.Option("--app", help="Serve a plain page without code (Voila).")] = False,
) -> None:
    """Open JupyterLab on the studio notebook and print the address to visit.

    In a checkout the notebook is notebooks/00_studio.ipynb; elsewhere it is sketchwidget-studio.ipynb in the current
    folder, written if missing.
    """
    package = "voila" if app else "jupyterlab"
    if find_spec(package) is None:
        fail(f"{package} is missing; install it with: pip install 'sketchwidget[notebooks]'")
    _require_free(host, port)
    if not app:
        _serve_lab(studio_notebook(Path()), host, port)
        return
    # The page is the Studio and nothing else, whatever the user's notebook holds.
    with TemporaryDirectory(prefix="sketchwidget-") as folder:
        _serve_page(_write_notebook(Path(folder)), host, port)


@main.command()
def models(yes: Annotated[bool, typer.Option("--yes", help="Do not ask.")] = False) -> None:
    """Fetch the models that find faces, landmarks, eyelids and persons in pictures (MediaPipe's, Apache-2.0)."""
    from sketchwidget.portrait.models import DOWNLOAD_MB, fetch, folder, missing

    wanted = missing()
    if not wanted:
        typer.echo(f"All portrait models are in {folder()}.")
        return
    typer.echo(f"Missing: {', '.join(wanted)}. They come from the package mediapipe, {DOWNLOAD_MB} MB through pip.")
    if not yes and not typer.confirm("Download?"):
        raise typer.Exit(1)
    fetch()
    typer.echo(f"The portrait models are in {folder()}.")


def studio_notebook(folder: Path) -> Path:
    """Give the notebook that shows the Studio.

    Parameters
    ----------
    folder
        Where to write a notebook if the package does not run from a checkout; one that is already there is kept.

    Returns
    -------
    Path
        The checkout's ``notebooks/00_studio.ipynb``, else ``sketchwidget-studio.ipynb`` in `folder`.

    Raises
    ------
    typer.Exit
        If `folder` cannot be written.
    """
    checkout = Path(__file__).resolve().parents[1] / "notebooks" / "00_studio.ipynb"
    if checkout.is_file():
        return checkout
    return _write_notebook(folder)


def _write_notebook(folder: Path) -> Path:
    """Write a notebook of the Studio alone into a folder, unless one is there; its absolute path."""
    path = folder / "sketchwidget-studio.ipynb"
    if not path.exists():
        try:
            path.write_text(json.dumps(_ONE_CELL, indent=1) + "\n", encoding="utf-8")
        except OSError as error:
            fail(f"cannot write {path}: {error.strerror}")
    return path.absolute()


_ONE_CELL = {
    "cells": [
        {
            "cell_type": "code",
            "execution_count": None,
            "id": "studio",
            "metadata": {},
            "outputs": [],
            "source": "import sketchwidget as sw\n\nsw.Studio()",
        }
    ],
    "metadata": {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}},
    "nbformat": 4,
    "nbformat_minor": 5,
}


def _require_free(host: str, port: int) -> None:
    """Fail with a message if nothing can listen on `host` and `port`."""
    try:
        family, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, socket.SOCK_STREAM) as probe:
            if os.name == "posix":  # elsewhere this option would allow a port that another server uses
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
    except OSError as error:
        fail(f"cannot listen on {host}, port {port}: {error.strerror}; choose with --host and --port")


def _announce(host: str, port: int, path: str, token: str) -> None:
    every = host in ("0.0.0.0", "::")
    for name in (socket.gethostname(), "127.0.0.1") if every else (f"[{host}]" if ":" in host else host,):
        typer.echo(f"The studio is at  http://{name}:{port}{path}?token={token}")
    typer.echo("Ctrl-C stops it.")


def _serve_lab(notebook: Path, host: str, port: int) -> None:
    from jupyterlab.labapp import LabApp

    path = f"/lab/tree/{quote(notebook.name)}"
    token = secrets.token_hex(24)
    # Containers have only root, whom Jupyter refuses by default; the token guards the server all the same.
    server = LabApp.initialize_server(
        [
            "--no-browser",
            "--allow-root",
            "--ServerApp.log_level=WARN",
            "--LabApp.log_level=WARN",
            f"--ServerApp.ip={host}",
            f"--ServerApp.port={port}",
            "--ServerApp.port_retries=0",
            "--ServerApp.base_url=/",
            f"--ServerApp.root_dir={notebook.parent}",
            f"--IdentityProvider.token={token}",
            f"--LabApp.default_url={path}",
            # Nothing is fetched from elsewhere, and no question about it lies over the Studio.
            "--LabApp.news_url=None",
            "--LabApp.check_for_updates_class=jupyterlab.handlers.announcements.NeverCheckForUpdate",
        ]
    )
    # The loop's first callback binds the port: after it, the address answers.
    server.io_loop.add_callback(_announce, host, port, path, token)
    server.start()


def _serve_page(notebook: Path, host: str, port: int) -> None:
    from tornado.ioloop import IOLoop
    from voila.app import Voila

    token = secrets.token_hex(24)
    # The loop starts once the port is bound.
    IOLoop.current().add_callback(_announce, host, port, "/", token)
    Voila.launch_instance(
        [
            str(notebook),
            "--no-browser",
            "--Voila.log_level=WARN",
            f"--Voila.ip={host}",
            f"--Voila.port={port}",
            "--Voila.port_retries=0",
            "--Voila.base_url=/",
            f"--Voila.token={token}",
        ]
    )
