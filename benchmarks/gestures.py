"""How well gestures are told apart: simulated writers that training has not met, and letters of somebody else's font.

python -m benchmarks.gestures
"""

from __future__ import annotations

import string
from pathlib import Path

import numpy as np
from HersheyFonts import HersheyFonts

import sketchwidget as sw
from sketchwidget.gesture.writers import Writer
from sketchwidget.training.gestures import HELD_OUT, NONE, measure, simulate, simulate_others

TABLE = Path(__file__).parent / "GESTURES.md"

# Whose shape is a gesture's: lines, loops, chevrons, and e and l, which are rolls of one loop.
LOOK_ALIKES = set("IlioOQD0" + "e1j")
FONTS = ("futural", "scripts", "cursive")


def letters(font: str) -> list[np.ndarray]:
    """Letters and digits of a vector font, each in one stroke: the pen stays down between those of the font."""
    loaded = HersheyFonts()
    loaded.load_default_font(font)
    drawn = []
    for letter in sorted(set(string.ascii_letters + string.digits) - LOOK_ALIKES):
        strokes = [np.array(stroke, dtype=float) for stroke in map(list, loaded.strokes_for_text(letter)) if stroke]
        if strokes and len(points := np.concatenate(strokes)) > 2:
            drawn.append(points)
    return drawn


def main() -> None:
    """Write `GESTURES.md` beside this file."""
    classifier = sw.GestureClassifier.load()
    found = measure(classifier, simulate(HELD_OUT, 200, 1) + simulate_others(HELD_OUT, 2_000, 1))
    random = np.random.default_rng(0)
    rows = []
    for font in FONTS:
        glyphs = letters(font)
        written = [(Writer.random(seed).write(path, random), NONE) for path in glyphs for seed in HELD_OUT[:10]]
        shares = [
            measure(classifier, [(path, NONE) for path in glyphs]).false_acceptance,
            measure(classifier, written).false_acceptance,
        ]
        rows.append(f"| {font} | {len(glyphs)} | {shares[0]:.1%} | {shares[1]:.1%} |")
    names = [*sw.GESTURES, "none"]
    lines = [
        "# Gestures told apart",
        "",
        "Strokes of *simulated* writers whom training has not met, 200 of each gesture; people may write otherwise.",
        f"{found.accuracy:.2%} are taken for what they are, {found.refused:.2%} are refused (not a gesture). Of 2,000"
        f" letters, signs and scribbles of the generator, {found.false_acceptance:.2%} are taken for a gesture.",
        "The paper has 96 % on recordings of its five users. Made by `python -m benchmarks.gestures`.",
        "",
        "| drawn, seen as | " + " | ".join(names) + " |",
        "|---|" + "---|" * len(names),
        *(
            f"| {name} | " + " | ".join(str(count or "") for count in row) + " |"
            for name, row in zip(names, found.confusion, strict=True)
        ),
        "",
        "Letters and digits of three Hershey fonts, which no training met, in one stroke each, without those whose"
        f" shape is a gesture's ({' '.join(sorted(LOOK_ALIKES))}): how many are taken for one, as they are in the font,"
        " and as ten simulated writers write them.",
        "",
        "| font | letters and digits | as they are | as written |",
        "|---|---|---|---|",
        *rows,
    ]
    TABLE.write_text("\n".join(lines) + "\n")
    print(TABLE.read_text())


if __name__ == "__main__":
    main()
