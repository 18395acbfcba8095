"""Alive Caricature against other methods on drawn caricatures: errors, left-out landmarks, regularity and time.

python -m benchmarks.caricature FOLDER

The folder holds the landmarks of a picture in each file `N.txt`, 68 lines "x y", as those that the paper's authors
published at https://github.com/QianyiWu/Caricature-Data. Without one, the environment's SKETCHWIDGET_CARICATURES names
it. None is part of this project.
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

import sketchwidget as sw
from benchmarks.caricature_methods import STRONG, WEAK, Fitted, Method, methods
from sketchwidget.caricature.fitting import deformable_head
from sketchwidget.caricature.jaw import JAW
from sketchwidget.face import PARTS
from sketchwidget.face.exaggeration import LEVELS
from sketchwidget.geometry.intersection import self_intersecting
from sketchwidget.geometry.regularity import folded
from sketchwidget.training.tables import machine

TABLE = Path(__file__).parent / "CARICATURE.md"
SPLITS, LEFT_OUT = 3, 10

_ABOUT = """# Caricatures

Heads fitted to the 68 landmarks of {count} caricatures, those that the authors of *Alive Caricature* published. Errors
are root mean squares over the distance of the outer eye corners, mean over the pictures; the jaw's landmarks are
measured to the silhouette of the posed face. *Left out*: fitted to {given} landmarks, measured at the other {left_out},
{splits} splits. *Folded*: per cent of the skin's edges whose triangles' normals are more than a right angle apart; the
mean face has {at_rest:.3f} % itself, at the sharp margin of the lids, and *new* are those besides. *Cuts*: pairs of
triangles that cut each other and do not in the mean face. Time: median of one fit. Made by
`python -m benchmarks.caricature` on {machine}.

| method | all | max | inner | jaw | left out | folded, % | max | new, % | cuts | time |
|---|---|---|---|---|---|---|---|---|---|---|"""
_PAPER = "| the paper's own meshes | 0.0204 | 0.042 | 0.0106 | 0.0351 | | 0.120 | 0.52 | | | < 40 s |"
_METHODS = """3DMM: principal components of {people} people at rest and of what expressions add to them, a standard
deviation of a weight worth {strong:g} mm² of landmark errors, (-) {weak:g} mm². Bilinear: identity and expression
weights without any prior. C-3DMM: principal components of all faces, those of four levels of exaggeration among them,
{weak:g} mm². ARAP: the landmarks of the result pulled onto their targets as rigidly as possible, by libigl. The paper's
meshes: one weak-perspective camera fitted to each of 50 published results, the jaw matched to the silhouette.
"""


class Measures:
    """What is measured of a fitted head."""

    def __init__(self, model: sw.FaceModel) -> None:
        skin = model.template.fine_parts == PARTS.index("skin")
        self._faces = model.faces[skin[model.faces].all(axis=1)]
        self._model, self._jaw = model, deformable_head(model).jaw
        self.people = len(model.bilinear.identities) // LEVELS
        self.folded_at_rest = folded(model.mean, self._faces)
        self._cut_at_rest = {tuple(pair) for pair in self_intersecting(model.mean, self._faces).tolist()}

    def errors(self, found: Fitted, landmarks: np.ndarray) -> np.ndarray:
        """Distances (68,) over that of the outer eye corners; jaw landmarks to the silhouette of the posed face."""
        places = self._model.landmarks.copy()
        jaw = self._jaw.match(found.vertices, found.camera, landmarks[:JAW], np.ones(JAW))
        places[:JAW] = jaw.vertices
        missed = np.linalg.norm(found.camera.project(found.vertices[places]) - landmarks, axis=1)
        return missed / np.linalg.norm(landmarks[36] - landmarks[45])

    def folds(self, found: Fitted) -> tuple[float, float]:
        """Per cent of the skin's edges that are folded: all, and those that the mean face does not fold."""
        now = folded(found.vertices, self._faces)
        return 100 * now.mean(), 100 * (now & ~self.folded_at_rest).mean()

    def cuts(self, found: Fitted) -> int:
        """Pairs of triangles of the skin that cut each other, and do not in the mean face."""
        pairs = {tuple(pair) for pair in self_intersecting(found.vertices, self._faces).tolist()}
        return len(pairs - self._cut_at_rest)


def read(folder: Path) -> dict[str, np.ndarray]:
    """Landmarks (68, 2) of each picture of a folder, by name."""
    files = sorted(folder.glob("*.txt"), key=lambda path: (len(path.stem), path.stem))
    if not files:
        raise FileNotFoundError(f"{folder} holds no landmarks (*.txt)")
    return {path.stem: np.loadtxt(path) for path in files}


def splits() -> list[np.ndarray]:
    """Weights (68,) that leave some landmarks out, each time others."""
    order = np.random.default_rng(0).permutation(68)
    left_out = [order[number * LEFT_OUT : (number + 1) * LEFT_OUT] for number in range(SPLITS)]
    return [np.where(np.isin(np.arange(68), out), 0.0, 1.0) for out in left_out]


def measured(method: Method, measures: Measures, pictures: dict[str, np.ndarray], bar: Callable) -> dict[str, list]:
    """Figures of one method, picture by picture."""
    found: dict[str, list] = {name: [] for name in ("all", "inner", "jaw", "left out", "folds", "new", "cuts", "time")}
    for landmarks in bar(pictures.values()):
        began = time.perf_counter()
        fitted = method(landmarks, np.ones(68))
        found["time"].append(time.perf_counter() - began)
        errors = measures.errors(fitted, landmarks)
        for name, part in (("all", errors), ("inner", errors[JAW:]), ("jaw", errors[:JAW])):
            found[name].append(_rms(part))
        for name, value in zip(("folds", "new"), measures.folds(fitted), strict=True):
            found[name].append(value)
        found["cuts"].append(measures.cuts(fitted))
        out = [measures.errors(method(landmarks, weights), landmarks)[weights == 0] for weights in splits()]
        found["left out"].append(_rms(np.concatenate(out)))
    return found


def _figures(pictures: dict[str, np.ndarray], measures: Measures) -> dict[str, Any]:
    """What the text of the table names."""
    return {
        "count": len(pictures),
        "given": 68 - LEFT_OUT,
        "left_out": LEFT_OUT,
        "splits": SPLITS,
        "at_rest": 100 * measures.folded_at_rest.mean(),
        "machine": machine(),
        "people": measures.people,
        "strong": STRONG,
        "weak": WEAK,
    }


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).mean()))


def main(folder: Path) -> None:
    """Write `CARICATURE.md` beside this file."""
    model, pictures = sw.FaceModel.load(), read(folder)
    measures = Measures(model)
    all_methods = methods(model)
    all_methods["ours"](next(iter(pictures.values())), np.ones(68))  # what is made once a model is made
    rows = []
    for name, method in all_methods.items():
        found = measured(method, measures, pictures, lambda each, name=name: tqdm(each, desc=name))
        mean = {key: statistics.mean(values) for key, values in found.items()}
        rows.append(
            f"| {name} | {mean['all']:.4f} | {max(found['all']):.3f} | {mean['inner']:.4f} | {mean['jaw']:.4f} |"
            f" {mean['left out']:.4f} | {mean['folds']:.3f} | {max(found['folds']):.2f} | {mean['new']:.3f} |"
            f" {mean['cuts']:.0f} | {statistics.median(found['time']):.2f} s |"
        )
    TABLE.write_text("\n".join([_ABOUT, *rows, _PAPER, "", _METHODS]).format(**_figures(pictures, measures)))
    print(TABLE.read_text())


if __name__ == "__main__":
    named = sys.argv[1] if len(sys.argv) > 1 else os.environ.get("SKETCHWIDGET_CARICATURES")
    if not named:
        sys.exit("name the folder of landmarks: python -m benchmarks.caricature FOLDER")
    main(Path(named))
