"""The commands that build a database of faces, `sketchwidget database`, and merge drawings, `sketchwidget drawings`."""

from __future__ import annotations

import shlex
import sys
import warnings
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand

if TYPE_CHECKING:
    from .source import FaceSource


class Resumable(TyperCommand):
    """A command that keeps what is finished, and goes on from there when it is started again: stopped, it says so."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            raise KeyboardInterrupt("the same command goes on from what is finished") from None


def command_line() -> str:
    """The command that runs, as it was typed; what it makes says so."""
    return shlex.join(["sketchwidget", *sys.argv[1:]])


drawings = typer.Typer(help="Drawings of known heads, as people made them.", no_args_is_help=True)


@drawings.callback()
def _group() -> None:
    """Keep the name of a command that is alone in its group."""


@drawings.command()
def merge(
    out: Annotated[Path, typer.Argument(metavar="OUT", help="File to write: a new one, or one of those merged.")],
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="Files of drawings.")],
) -> None:
    """Write the drawings of several files into one, each of those that are equal once."""
    from .drawings import merge as merge_files

    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        kept, dropped = merge_files(files, out)
    for warning in told:
        typer.echo(f"sketchwidget: {warning.message}", err=True)
    others = "; the others are equal to one of these" if dropped else ""
    typer.echo(f"{out}: {kept:,} of {kept + dropped:,} drawings{others}")


class SourceName(StrEnum):
    """Where faces come from."""

    ANNY = "anny"
    ICT = "ict"
    FOLDER = "folder"


class PresetName(StrEnum):
    """How much to build."""

    TINY = "tiny"
    PAPER = "paper"


def database(
    out: Annotated[Path, typer.Option(help="Folder of the database; one that was begun there goes on.")],
    preset: Annotated[PresetName, typer.Option(help="150 identities as in the paper, or two to see it run.")] = (
        PresetName.PAPER
    ),
    source: Annotated[
        SourceName, typer.Option(help="The package anny, a clone of ICT-FaceKit, or meshes in a folder.")
    ] = (SourceName.ANNY),
    path: Annotated[Path | None, typer.Option(help="The clone or the folder.")] = None,
    identities: Annotated[int | None, typer.Option(min=1, help="Another number of them than the preset's.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Processes.")] = 1,
) -> None:
    """Build a database of faces, identities x expressions x 4 levels of exaggeration, and their bilinear model."""
    from .build import PRESETS, build
    from .database import FaceDatabase
    from .provenance import licence, provenance

    chosen = PRESETS[preset]
    made = provenance(command_line(), ("numpy", "scipy", "libigl", "tensorly"))
    made |= {"source": source, "licence": licence(source)}
    count = chosen.identities if identities is None else identities
    build(open_source(source, path), out, count, chosen.interpolated, jobs, made)
    faces = FaceDatabase.open(out)
    crossing = ", ".join(f"{name} {100 * share:.2f} %" for name, share in faces.crossing.items())
    typer.echo(f"{out}: {len(faces):,} faces and {len(faces.interpolated):,} between them; sum {faces.sum}")
    typer.echo(f"Faces in which parts cut each other: {crossing}")


def open_source(name: SourceName, path: Path | None) -> FaceSource:
    """A source of faces by its name.

    Raises
    ------
    ValueError
        If it reads a folder and none is given.
    """
    if name is SourceName.ANNY:
        from .anny import AnnySource

        if path is not None:
            raise ValueError(f"the source {name} reads no folder: leave --path out, or choose another --source")
        return AnnySource()
    if path is None:
        raise ValueError(f"the source {name} reads a folder: name it with --path")
    if name is SourceName.ICT:
        from .ict import ICTFaceKitSource

        return ICTFaceKitSource(path)
    from .folder import MeshFolderSource

    return MeshFolderSource(path)
