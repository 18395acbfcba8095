"""How the error on people left out falls while networks train: one curve for each training in a work folder.

sketchwidget train network faces --out shape.safetensors && python -m benchmarks.learning runs
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
import numpy as np

from sketchwidget.training.curve import read_curve

PICTURE = Path(__file__).with_name("learning.png")


def main(work: str) -> None:
    """Draw `learning.png` beside this file: the vertex loss with the shape of the lines where a network sees it."""
    matplotlib.use("Agg")
    from matplotlib import pyplot

    found = sorted(Path(work).glob("*/unseen.csv"))
    if not found:
        raise SystemExit(f"no training has been in {work}: it would have left a file unseen.csv")
    figure, axes = pyplot.subplots(figsize=(7, 4), layout="constrained")
    for path in found:
        rows = np.array(read_curve(path)[1])
        name, _, _ = path.parent.name.rpartition("-")  # the rest is the fingerprint of the face model
        axes.plot(rows[:, 1] / 60, rows[:, -1], label=name)
    axes.set(
        xlabel="minutes of training",
        ylabel="vertex loss, mm",
        title="People left out, augmented drawings",
        yscale="log",
    )
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize=8)
    figure.savefig(PICTURE, dpi=110)


if __name__ == "__main__":
    main(sys.argv[1])
