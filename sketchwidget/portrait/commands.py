"""The command that fetches the portrait models, `sketchwidget models`."""

from __future__ import annotations

from typing import Annotated

import typer


def models(yes: Annotated[bool, typer.Option("--yes", help="Do not ask.")] = False) -> None:
    """Fetch the models that find faces, landmarks, eyelids and persons in pictures (MediaPipe's, Apache-2.0)."""
    from .models import DOWNLOAD_MB, fetch, folder, missing

    wanted = missing()
    if not wanted:
        typer.echo(f"All portrait models are in {folder()}.")
        return
    typer.echo(f"Missing: {', '.join(wanted)}. They come from the package mediapipe, {DOWNLOAD_MB} MB through pip.")
    if not yes and not typer.confirm("Download?"):
        raise typer.Exit(1)
    fetch()
    typer.echo(f"The portrait models are in {folder()}.")
