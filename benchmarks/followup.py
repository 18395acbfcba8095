"""Figure 9 of DeepSketch2Face, and its measure: editing the template with and without inference.

python -m benchmarks.followup FACES [--faces 60]

For faces of people that the network was not trained on, a script takes each line of the template away and draws that of
the face in its place, wrinkles too. The sketch is exact, so that what differs is what inference makes of it.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from PIL import Image
from scipy.spatial import KDTree
from tqdm import tqdm

import sketchwidget as sw
from sketchwidget.face.drawing import editable
from sketchwidget.face.handles import LINES
from sketchwidget.face.template import PARTS
from sketchwidget.geometry import View
from sketchwidget.session import Session
from sketchwidget.sketch import SILHOUETTE, WRINKLE, resample
from sketchwidget.training.pipeline import Pipeline

HERE = Path(__file__).parent
TABLE, PICTURE = HERE / "FOLLOWUP.md", HERE / "followup.png"

_ERASER = 0.002  # canvas units: nothing else is touched
_ROUNDS = ((0.05, 0.55), (0.45, 1.15), (0.9, 1.4))  # shares of the outline; what a stroke is joined to is drawn anew
_SHOWN = 5
_SIZE = 240


def redraw(session: Session, face: sw.Face) -> None:
    """Erase each line of the template in a session, and draw that of a face in its place."""
    drawing = editable(face.model.template, face.vertices, View()).lines
    (outline,) = drawing[SILHOUETTE]
    for start, end in _ROUNDS:
        session.erase(_stretch(session, start, end), radius=_ERASER)
        first, last = KDTree(outline[:-1]).query(session.gap.erased.points[[0, -1]])[1]
        around = (last - first) % (len(outline) - 1)
        session.draw(outline[np.arange(first, first + around + 1) % (len(outline) - 1)])
    for name in LINES[1:]:
        while pieces := session.sketch.lines.get(name):
            if not session.erase(_apart(session.sketch, pieces[0]), radius=_ERASER) or session.gap.name != name:
                raise RuntimeError(f"a piece of the line {name} is too near to another one to be erased")
        session.draw(np.concatenate(drawing[name]))
    for wrinkle in face.sketch().lines.get(WRINKLE, []):
        session.draw(wrinkle)


def _apart(sketch: sw.Sketch, piece: np.ndarray) -> np.ndarray:
    """The point of a piece that is the furthest from all others."""
    others = [resample(segment.points, 500) for segment in sketch.segments if segment.points is not piece]
    return piece[np.argmax(KDTree(np.concatenate(others)).query(piece)[0])]


def _stretch(session: Session, start: float, end: float) -> np.ndarray:
    """A part of the outline as it is, by shares of its handle points."""
    handle = session.frame.project(session.face.curve(SILHOUETTE))[:-1]
    return handle[np.arange(round(start * len(handle)), round(end * len(handle))) % len(handle)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("database", type=Path)
    parser.add_argument("--faces", type=int, default=60)
    arguments = parser.parse_args()
    database, regressor = sw.FaceDatabase.open(arguments.database), sw.FaceRegressor.load()
    if regressor.database != database.sum:
        parser.error("the shipped network was trained on another database: whom of this one it met is not known")
    numbers = Pipeline(database, Path("runs")).unseen("identity", arguments.faces)
    skin = regressor.model.template.fine_parts == PARTS.index("skin")
    rows, pictures = [], []
    for number in tqdm(numbers, unit="face"):
        face = sw.Face(regressor.model, database[int(number)].vertices)
        plain = Session(regressor, inference=False)
        redraw(plain, face)
        inferred = Session.loads(plain.dumps(), regressor, inference=True)
        heads = [regressor.model.face(), regressor.predict(inferred.sketch), plain.face, inferred.face]
        rows.append([_errors(head.vertices[skin], face.vertices[skin]) for head in heads])
        if len(pictures) < _SHOWN:
            shown = [
                inferred.sketch.picture(_SIZE),
                *(
                    head.picture(view, _SIZE)
                    for head in (inferred.face, plain.face, face)
                    for view in ("front", "three-quarter")
                ),
            ]
            pictures.append(np.concatenate(shown, axis=1))
    Image.fromarray(np.concatenate(pictures)).save(PICTURE, optimize=True)
    TABLE.write_text(_table(np.array(rows), len(numbers)))
    print(TABLE.read_text())


def _errors(found: np.ndarray, true: np.ndarray) -> tuple[float, float]:
    """Mean distance of vertices, and mean distance in depth alone."""
    return float(np.linalg.norm(found - true, axis=1).mean()), float(np.abs(found - true)[:, 2].mean())


def _table(errors: np.ndarray, count: int) -> str:
    names = ("template", "inference alone", "deformation of the template", "inference and deformation")
    lines = [
        "# Follow-up sketching with and without inference",
        "",
        f"Figure 9 and section 6.1 of *DeepSketch2Face*, measured. {count} faces of people that the network was not",
        "trained on; a script redraws each line of the template as the face has it, and its wrinkles. Mean distance of",
        "skin vertices from the true ones, in mm; the mean face is 200 mm high. Made by",
        "`python -m benchmarks.followup FACES`.",
        "",
        "| | distance | of it in depth | nearer than the other interface, faces |",
        "|---|---|---|---|",
    ]
    wins = int((errors[:, 3, 0] < errors[:, 2, 0]).sum())
    for row, name in enumerate(names):
        share = {2: str(count - wins), 3: str(wins)}.get(row, "")
        lines.append(f"| {name} | {errors[:, row, 0].mean():.2f} | {errors[:, row, 1].mean():.2f} | {share} |")
    lines += ["", "![Sketch; inference and deformation; deformation of the template; the face](followup.png)"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
