"""Heads from portraits: the paper's Tables 1 and 2 on rendered and on real ones, and what each stage takes.

python -m benchmarks.avatar [--pictures FOLDER]

The folder holds pictures (1.jpg) with landmarks (1.txt, 68 lines of x and y), to be measured too.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

import numpy as np
import torch
from skimage import data

from sketchwidget import FaceModel
from sketchwidget.avatar import build
from sketchwidget.avatar.build import person_about, squared
from sketchwidget.avatar.coarse import WHOLE
from sketchwidget.avatar.eyes import fit_eyeballs
from sketchwidget.avatar.network import PortraitNetwork
from sketchwidget.avatar.rig import Blend, RigBuilder
from sketchwidget.avatar.stylize import drawn
from sketchwidget.avatar.template import AvatarTemplate
from sketchwidget.portrait import FaceLandmarks, load_picture
from sketchwidget.portrait.mask import face_oval
from sketchwidget.portrait.mediapipe import MediaPipeDetector
from sketchwidget.portrait.models import missing
from sketchwidget.training.portraits import render_portrait
from sketchwidget.training.tables import machine

from .avatar_methods import LARGER_EYES, PARTS, SHORT, Case, Methods

TABLE = Path(__file__).parent / "AVATAR.md"
HEADS, FIRST = 8, 1_000_000  # rendered; no training set holds their numbers
_COLUMNS = (*PARTS, "shape", "photometric", "seconds")
Figures = dict[str, dict[str, float]]


def main() -> None:
    """Write `AVATAR.md` beside this file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pictures", type=Path, help="folder of pictures with landmarks")
    given = parser.parse_args()
    stages = _stages()  # first, so that nothing is loaded yet
    torch.set_num_threads(1)
    model, template = FaceModel.load(), AvatarTemplate.load()
    methods = Methods(model, template, PortraitNetwork.load(model))
    cases: dict[str, list[Case]] = {"portrait": [], "cartoon": []}
    for seed in range(FIRST, FIRST + HEADS):
        case = Case.of(render_portrait(model, template, seed))
        cases["portrait"].append(case)
        cases["cartoon"].append(case.drawn())
    rendered = {kind: _means([methods.errors(case) for case in of_kind]) for kind, of_kind in cases.items()}
    lines = [*_heading(), *_rendered(rendered)]
    real = {kind: of_kind for kind, of_kind in _real(given.pictures) if of_kind}
    if real:
        measured = {kind: _means([methods.errors(case) for case in of_kind]) for kind, of_kind in real.items()}
        heads = [methods.head(case) for kind, of_kind in real.items() if kind != "as a cartoon" for case in of_kind]
        apart = [methods.apart(one, other) for one, other in combinations(heads, 2)]
        lines += _on_real(real, measured, apart)
    TABLE.write_text("\n".join([*lines, *stages, *_rig(model, template), ""]))
    print(TABLE.read_text())


def _real(folder: Path | None) -> Iterator[tuple[str, list[Case]]]:
    """Kinds of real pictures, each with its portraits."""
    if not missing():
        detector, picture = MediaPipeDetector(), data.astronaut()
        marks = detector.landmarks(picture, detector.faces(picture)[0])
        case = _case(picture, marks)
        made = drawn(case.image, case.marks)
        yield "photograph", [case]
        yield "as a cartoon", [_masked(made.image, made.marks.snapped())]
    if folder is not None:
        files = sorted(folder.glob("*.txt"))
        yield (
            "caricatures",
            [_case(load_picture(file.with_suffix(".jpg")), FaceLandmarks(np.loadtxt(file))) for file in files],
        )


def _case(picture: np.ndarray, marks: FaceLandmarks) -> Case:
    square, to_square, _ = squared(picture, marks)
    return _masked(square, marks.moved(to_square).snapped())


def _masked(square: np.ndarray, marks: FaceLandmarks) -> Case:
    return Case(square, marks, person_about(square, marks) * face_oval(marks.points, square.shape[:2]))


def _means(found: list[Figures]) -> Figures:
    return {
        method: {name: float(np.mean([row[method][name] for row in found])) for name in found[0][method]}
        for method in found[0]
    }


def _heading() -> list[str]:
    return [
        "# Heads from portraits",
        "",
        f"`python -m benchmarks.avatar`, {machine()}.",
        "",
        "Landmark errors in hundredths of the distance between the outer corners of the eyes, those of brows and",
        "contour from the line of the landmarks; shape in millimetres over the front of a face 200 mm high, aligned,",
        "against the head before it was drawn; photometric: mean Manhattan distance of colours, 0 to 1 a channel, over",
        "the front of the face; seconds of one core. `coarse` optimises equation 3 from the mean face, `fine` goes on",
        "from there by equation 10 (Table 1); expression, or identity and expression, adjusted instead are the paper's",
        "Table 2. `network alone` is the first guess of the shipped one; `network, then coarse` is what `build` does.",
        f"`short` is {SHORT[0]} steps with landmarks and {SHORT[1]} with colours instead of {WHOLE[0]} and {WHOLE[1]}.",
        "",
    ]


def _rendered(kinds: dict[str, Figures]) -> list[str]:
    return [
        "## Rendered heads",
        "",
        f"{HEADS} heads whose shape is known, landmarks exact; as they are, and drawn as cartoons with eyes"
        f" {100 * LARGER_EYES:.0f} % larger.",
        "",
        *_rows(kinds),
    ]


def _on_real(cases: dict[str, list[Case]], kinds: dict[str, Figures], apart: list[float]) -> list[str]:
    counts = ", ".join(f"{name}: {len(of_kind)}" for name, of_kind in cases.items())
    lines = [
        "## Real portraits",
        "",
        f"Pictures by kind: {counts}.",
        "The photograph is scikit-image's astronaut, its landmarks as the detector finds them, as it is and as the",
        "cartoon that `build` works on; the caricatures are those of Alive Caricature that `--pictures` names, with",
        "the landmarks that people set. Their shape nobody knows.",
        "",
        *_rows(kinds),
    ]
    if apart:
        lines += [
            f"Two people give two heads: at rest, those of any two of the pictures are {np.mean(apart):.1f} mm apart in"
            f" the mean, and {np.min(apart):.1f} mm where they are nearest.",
            "",
        ]
    return lines


def _rows(kinds: dict[str, Figures]) -> list[str]:
    lines = [f"| method | {' | '.join(_COLUMNS)} |", f"|---|{'---:|' * len(_COLUMNS)}"]
    for kind, methods in kinds.items():
        for method, figures in methods.items():
            cells = [f"{figures[name]:.2f}" if name in figures else "" for name in _COLUMNS]
            lines.append(f"| {kind}, {method} | {' | '.join(cells)} |")
    return [*lines, ""]


def _stages() -> list[str]:
    """What each stage from a file to a head takes, the first time and again."""
    if missing():
        return []
    columns = [_seconds_of_stages() for _ in range(4)]
    again = {name: float(np.median([column[name] for column in columns[1:]])) for name in columns[0]}
    first = columns[0]
    lines = [
        "## Stages",
        "",
        "Seconds of the processor, all cores together, from a photograph without landmarks to the avatar: the first",
        "one of a process, model and networks read from the disk, and later ones.",
        "",
        "| stage | first | later |",
        "|---|---:|---:|",
    ]
    lines += [f"| {name} | {first[name]:.2f} | {again[name]:.2f} |" for name in first]
    return [*lines, f"| all | {sum(first.values()):.2f} | {sum(again.values()):.2f} |", ""]


def _seconds_of_stages() -> dict[str, float]:
    spent: dict[str, float] = {}
    began = [time.process_time()]

    def report(stage: str, *_: object) -> None:
        now = time.process_time()
        spent[stage], began[0] = now - began[0], now

    picture = data.astronaut()
    began[0] = time.process_time()
    build(picture, report=report)
    return spent


def _rig(model: FaceModel, template: AvatarTemplate) -> list[str]:
    """Evaluations of a rig a second, all weights active, by the processor's time."""
    neutral = template.neutral.astype(np.float64)
    head = model.template.subdivision @ neutral
    rig, _ = RigBuilder(model, template)(neutral, fit_eyeballs(model, head, head))
    blend, weights = Blend(head, rig), dict.fromkeys(rig, 0.5)
    rates = []
    for _ in range(5):
        start = time.process_time()
        for _ in range(200):
            blend(weights)
        rates.append(200 / (time.process_time() - start))
    return [f"Rig, {len(rig)} expressions, all weights active: {np.median(rates):,.0f} evaluations a second of a core."]


if __name__ == "__main__":
    main()
