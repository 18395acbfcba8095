"""What a bilinear model of a built database can hold, by its rank: where does the error stop falling?

sketchwidget database --preset paper --out faces && python -m benchmarks.ranks faces
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
import numpy as np
from tqdm import tqdm

import sketchwidget as sw
from sketchwidget.database.anny import AnnySource
from sketchwidget.database.build import MODEL_IDENTITIES, prepare
from sketchwidget.database.store import Store
from sketchwidget.face import PARTS
from sketchwidget.face.bilinear import Bilinear, fit
from sketchwidget.face.decomposition import COMPONENTS, decompose
from sketchwidget.face.exaggeration import LEVELS
from sketchwidget.training.tables import machine

RANKS = ((10, 16), (25, 16), (50, 16), (75, 16), (100, 16), (50, 8), (50, 12), (50, 25))
LEFT_OUT = 12  # identities after those of the model
SAMPLES = 300  # faces of each kind
FOLDER = Path(__file__).parent


def main(path: str) -> None:
    """Write `RANKS.md` and `ranks.png` beside this file."""
    store, database = Store.open(Path(path)), sw.FaceDatabase.open(path)
    template = database.model.template
    skin = template.subdivision[template.fine_parts == PARTS.index("skin")]
    people, expressions = min(database.identities, MODEL_IDENTITIES), len(database.expressions)
    tensor = np.concatenate([store.read(number).vertices for number in range(people)])
    tensor = tensor.reshape(people * LEVELS, expressions, -1)
    maker = prepare(AnnySource(), people)
    unseen = [maker(people + number).vertices for number in tqdm(range(LEFT_OUT), desc="left out", unit="head")]
    random = np.random.default_rng(0)
    unseen = np.stack(unseen).reshape(-1, tensor.shape[-1])
    unseen = unseen[random.permutation(len(unseen))[:SAMPLES]]
    seen = random.integers([people * LEVELS, expressions], size=(SAMPLES, 2))

    def error(model: Bilinear, mesh: np.ndarray, u: np.ndarray, v: np.ndarray) -> float:
        difference = model.mesh(u, v) - mesh
        return float(np.linalg.norm(skin @ difference.reshape(-1, 3), axis=1).mean())

    rows, held = [], {}
    for rank in tqdm(RANKS, desc="ranks"):
        model = decompose(tensor, rank, COMPONENTS)
        training = [error(model, tensor[i, e], model.identities[i], model.expressions[e]) for i, e in seen]
        left_out = [error(model, mesh, *fit(model, mesh)) for mesh in unseen]
        held[rank] = (np.mean(training), np.mean(left_out))
        figures = [
            f"{f(errors):.2f}" for errors in (training, left_out) for f in (np.mean, lambda e: np.percentile(e, 95))
        ]
        rows.append(f"| {rank[0]} x {rank[1]} | {' | '.join(figures)} |")
    (FOLDER / "RANKS.md").write_text(
        f"""# What the model holds, by rank

Mean distance in mm between the skin of a face and of the model's nearest face, the mean face 200 mm high: mean and 95th
percentile over {SAMPLES} faces of the {people * LEVELS} x {expressions} that the model is made of, and over as many of
{LEFT_OUT} identities after them, all levels of exaggeration among them. {COMPONENTS} components of the vertex mode.
Made by `python -m benchmarks.ranks` on {machine()}.

| identity x expression | training, mean | 95 % | left out, mean | 95 % |
|---|---|---|---|---|
"""
        + "\n".join(rows)
        + "\n\n![Error against the identity rank](ranks.png)\n"
    )
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(5, 3), layout="constrained")
    ranks = [rank for rank in RANKS if rank[1] == 16]
    for number, name in enumerate(("training", "identities left out")):
        axes.plot([rank[0] for rank in ranks], [held[rank][number] for rank in ranks], marker="o", label=name)
    axes.set(xlabel="identity rank (expression rank 16)", ylabel="mean error, mm", ylim=(0, None))
    axes.legend()
    figure.savefig(FOLDER / "ranks.png", dpi=110)
    print((FOLDER / "RANKS.md").read_text())


if __name__ == "__main__":
    main(sys.argv[1])
