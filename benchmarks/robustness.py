"""How heads answer to what people draw: do they show what was meant, and how near are their lines to the drawn ones?

python -m benchmarks.robustness [drawings.ndjson of QuickDraw smiley faces]
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from pathlib import Path

import cv2
import numpy as np
from scipy.spatial import KDTree
from skimage.io import imsave

import sketchwidget as sw
from sketchwidget.face.drawing import outline
from sketchwidget.inference.framing import place
from sketchwidget.inference.regressor import Inference
from sketchwidget.sketch import FEATURES, SILHOUETTE, resample

from .expression import MEANINGS, Reading

TABLE = Path(__file__).parent / "ROBUSTNESS.md"
DRAWINGS = Path(__file__).parent.parent / "docs" / "freehand"
SHEET = DRAWINGS.with_suffix(".png")
SIZE, COLUMNS = 150, 7
MISSED = (214, 39, 40)


def freehand() -> list[tuple[str, sw.Sketch, list[str]]]:
    """Name, drawing and meaning of the fifty faces."""
    meanings = json.loads((DRAWINGS / "meanings.json").read_text())
    return [(name, sw.Sketch.load(DRAWINGS / f"{name}.json"), meanings[name]) for name in sorted(meanings)]


def quickdraw(path: Path) -> list[tuple[str, sw.Sketch, list[str]]]:
    """The same of QuickDraw's smiley faces, each of which is to smile."""
    drawings = [json.loads(line)["drawing"] for line in path.read_text().splitlines()]
    return [
        (f"QuickDraw {number}", sw.Sketch.from_strokes([np.array(stroke).T / 320 + 0.1 for stroke in one]), ["smile"])
        for number, one in enumerate(drawings)
    ]


def line_distance(sketch: sw.Sketch, names: tuple[str, ...], face: sw.Face, view: sw.View) -> float:
    """Mean distance of the drawn lines that have a name from the head's lines of that kind, in % of its height."""
    lines = {name: view.project(face.curve(name)) for name in FEATURES}
    lines[SILHOUETTE] = outline(view.project(face.curve(SILHOUETTE)))
    apart = []
    for name, segment in zip(names, sketch.segments, strict=True):
        if name in lines and len(segment.points) > 1:
            others = [line for other, line in lines.items() if _part(other) == _part(name)]
            tree = KDTree(np.concatenate([resample(line, 200) for line in others]))
            apart.append(tree.query(resample(segment.points, 60))[0])
    height = np.ptp(lines[SILHOUETTE][:, 1])
    return 100 * float(np.concatenate(apart).mean() / height) if apart else np.nan


def _part(name: str) -> str:
    """One ellipse is two contours of an eye, and one line may be both of a mouth."""
    return name.removesuffix("_upper").removesuffix("_lower")


def mean_face_distance(sketch: sw.Sketch, found: Inference) -> float:
    """The same for the mean face, put where the drawing is."""
    face = found.face.model.face()
    drawn = [s.points for s, name in zip(sketch.segments, found.names, strict=True) if name == SILHOUETTE]
    if not drawn:
        return np.nan
    view = place(outline(sw.View().project(face.curve(SILHOUETTE))), np.concatenate(drawn))
    return line_distance(sketch, found.names, face, view)


def tile(sketch: sw.Sketch, found: Inference, missed: list[str]) -> np.ndarray:
    """A drawing in the colours of what its strokes were taken for, and the head, framed if it misses its meaning."""
    head = np.array(found.face.picture("front", SIZE))
    if missed:
        cv2.rectangle(head, (1, 1), (SIZE - 2, SIZE - 2), MISSED, 2)
    return np.hstack([sketch.renamed(found.names).picture(SIZE), head])


def measure(drawings: list[tuple[str, sw.Sketch, list[str]]], regressor: sw.FaceRegressor, sheet: Path | None) -> dict:
    """Shares of meanings shown, and line distances."""
    asked, shown, whole, distances, tiles, missing = Counter(), Counter(), [], [], [], {}
    for name, sketch, meanings in drawings:
        found = regressor.infer(sketch)
        reading = Reading(found.face)
        missed = [meaning for meaning in meanings if not reading.shows(meaning)]
        asked.update(meanings)
        shown.update(set(meanings) - set(missed))
        whole.append(not missed)
        distances.append(
            (line_distance(sketch, found.names, found.face, found.frame), mean_face_distance(sketch, found))
        )
        tiles.append(tile(sketch, found, missed))
        if missed:
            missing[name] = missed
    if sheet is not None:
        tiles += [np.full_like(tiles[0], 255)] * (-len(tiles) % COLUMNS)
        rows = [np.hstack(tiles[start : start + COLUMNS]) for start in range(0, len(tiles), COLUMNS)]
        imsave(sheet, np.vstack(rows), check_contrast=False)
    ours, mean = np.nanmean(distances, axis=0)
    return {
        "shown": {meaning: (shown[meaning], asked[meaning]) for meaning in MEANINGS if asked[meaning]},
        "whole": np.mean(whole),
        "distance": ours,
        "mean face": mean,
        "missing": missing,
    }


def main(path: Path | None = None) -> None:
    """Write `ROBUSTNESS.md` beside this file, and the sheet of freehand drawings."""
    ways = {"network": sw.FaceRegressor.load(refine=False), "refined by lines": sw.FaceRegressor.load()}
    shipped = "refined by lines"
    sets = {"fifty freehand faces": freehand()} | ({"QuickDraw smileys": quickdraw(path)} if path else {})
    found = {
        (kind, way): measure(drawings, regressor, SHEET if (kind, way) == ("fifty freehand faces", shipped) else None)
        for kind, drawings in sets.items()
        for way, regressor in ways.items()
    }
    lines = [
        "# Robustness",
        "",
        "Drawings whose makers meant something: do the landmarks of the head show it, against the same person at rest,",
        "and how far are the drawn lines from the head's lines of the same kind, in percent of the face's height? The",
        "fifty faces are those of docs/freehand; QuickDraw's smileys (Google, CC BY 4.0) are not in this repository.",
        "The constants of the refinement were chosen on the fifty faces, QuickDraw's were not looked at for it.",
        "Made by `python -m benchmarks.robustness [smileys.ndjson]`.",
        "",
        "| drawings | heads | all that was meant shows | lines apart | mean face's lines apart |",
        "|---|---|---|---|---|",
    ]
    for (kind_, way), one in found.items():
        lines.append(f"| {kind_} | {way} | {one['whole']:.0%} | {one['distance']:.2f} % | {one['mean face']:.2f} % |")
    lines += [
        "",
        "| fifty freehand faces: meant | " + " | ".join(f"shown: {way}" for way in ways) + " |",
        "|---|---|---|",
    ]
    for meaning in found["fifty freehand faces", shipped]["shown"]:
        shares = ["{} of {}".format(*found["fifty freehand faces", way]["shown"][meaning]) for way in ways]
        lines.append(f"| {meaning} | " + " | ".join(shares) + " |")
    missing = found["fifty freehand faces", shipped]["missing"]
    lines += ["", "What is missed, framed in red in docs/freehand.png: " + "; ".join(
        f"{name} ({', '.join(missed)})" for name, missed in missing.items()) + "."]  # fmt: skip
    TABLE.write_text("\n".join(lines) + "\n")
    print(TABLE.read_text())


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
