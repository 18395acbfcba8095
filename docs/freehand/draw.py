"""Thirty-eight faces as people doodle them, each with what it means to show; they join the twelve drawn by hand.

Drawn from a few words a face, independently of the simulated hand that networks train with:

python docs/freehand/draw.py
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from scipy.interpolate import make_interp_spline

import sketchwidget as sw

FOLDER = Path(__file__).parent
MEANINGS = FOLDER / "meanings.json"

# Half the greatest width, in canvas units, and how much wider than an ellipse at crown, eyes, cheeks, jaw and chin.
OUTLINES = {
    "oval": (0.25, 1.00, 1.00, 1.00, 0.98, 0.95),
    "egg": (0.27, 1.05, 1.02, 0.96, 0.88, 0.82),
    "long": (0.19, 1.00, 1.00, 1.00, 1.02, 1.00),
    "round": (0.33, 1.00, 1.00, 1.00, 1.00, 1.00),
    "broad": (0.33, 0.95, 1.00, 1.05, 1.12, 1.15),
    "square": (0.26, 1.15, 1.00, 1.02, 1.20, 1.30),
    "jowls": (0.24, 0.85, 0.88, 1.02, 1.40, 1.45),
    "heart": (0.28, 1.10, 1.04, 0.92, 0.72, 0.60),
}
WHERE = (0.0, 0.35, 0.55, 0.78, 1.0)
TOP, BOTTOM = 0.10, 0.90

# Number, outline, what of it is drawn, eyes, brows, nose, mouth, further strokes, and what the face means to show.
FACES = """
13 calm_dots          oval   closed    dots     none     none    flat       -             neutral
14 small_smile        oval   closed    almond   arched   hook    smirk      -             smile
15 broad_grin         egg    closed    almond   arched   base    grin       -             smile
16 toothy_laugh       round  closed    arcs     raised   base    teeth      -             smile open
17 crying             oval   closed    almond   worried  hook    frown      tears         sad worried
18 furious            square closed    lens     angry    wings   snarl      furrows       frown
19 astonished         egg    closed    circles  raised   base    o          -             open raised
20 yawning            long   closed    shut     raised   base    tall_o     -             open shut
21 asleep             round  closed    shut     arched   base    flat       -             shut
22 wink_left          oval   closed    wink     arched   hook    smile      -             smile wink
23 eyes_only          oval   closed    almond   none     none    none       -             neutral
24 no_mouth           egg    closed    circles  arched   base    none       -             neutral
25 hair_and_ears      oval   closed    almond   arched   hook    smile      hair,ears     smile
26 bearded            square closed    almond   flat     wings   flat       beard         neutral
27 glasses            oval   closed    almond   flat     base    smile      glasses       smile
28 pupils             round  closed    pupils   arched   base    smile      ears          smile
29 open_top           oval   open      almond   flat     hook    flat       hair          neutral
30 open_top_laugh     egg    open      arcs     raised   base    laugh      hair          smile open
31 double_stroke      oval   double    almond   double   hook    smile      -             smile
32 long_sad           long   closed    almond   worried  long    frown      -             sad long
33 long_calm          long   closed    almond   flat     long    flat       ears          neutral long
34 broad_smile        broad  closed    almond   arched   wings   smile      ears          smile broad
35 broad_frown        broad  closed    lens     angry    wings   frown      -             frown broad
36 jowly              jowls  closed    almond   flat     wings   flat       ears          jowly neutral
37 jowly_grin         jowls  closed    arcs     arched   base    grin       -             jowly smile
38 pointed_chin       heart  closed    almond   arched   hook    smirk      -             narrow smile
39 pointed_shock      heart  closed    circles  raised   base    o          hair          narrow open raised
40 off_centre         oval   closed    almond   arched   hook    smile      moved         smile
41 tiny               oval   closed    almond   flat     base    frown      small         sad
42 tilted             oval   closed    almond   arched   hook    smile      tilted        smile
43 lopsided           egg    lopsided  almond   arched   hook    flat       -             neutral
44 lips               oval   closed    almond   arched   base    full_lips  hair          neutral
45 lips_apart         egg    closed    almond   arched   hook    parted     -             open
46 sneer              square closed    lens     angry    hook    skewed     furrows       frown
47 sad_dots           round  closed    dots     worried  none    frown      -             sad worried
48 happy_dots         oval   closed    dots     arched   none    laugh      -             smile open
49 shouting           square closed    lens     angry    wings   rectangle  furrows       open frown
50 old_man            long   closed    almond   flat     long    flat       ears,wrinkles neutral long
"""


def spline(points: list[tuple[float, float]] | np.ndarray, count: int = 40) -> np.ndarray:
    """A smooth line (count, 2) through a few points."""
    points = np.asarray(points, dtype=np.float64)
    along = np.r_[0, np.cumsum(np.hypot(*np.diff(points, axis=0).T))]
    return make_interp_spline(along, points, k=min(3, len(points) - 1))(np.linspace(0, along[-1], count))


def ellipse(x: float, y: float, a: float, b: float) -> np.ndarray:
    """A closed ellipse (33, 2)."""
    angle = np.linspace(0.3, 2 * np.pi + 0.3, 33)
    return np.stack([x + a * np.cos(angle), y + b * np.sin(angle)], axis=1)


def arc(x: float, y: float, half: float, rise: float) -> np.ndarray:
    """A line between (x - half, y) and (x + half, y) whose middle lies `rise` higher."""
    along = np.linspace(-1, 1, 17)
    return np.stack([x + half * along, y - rise * (1 - along**2)], axis=1)


def outline(shape: str, manner: str) -> list[np.ndarray]:
    """The strokes of a head's outline."""
    half, *wider = OUTLINES[shape]
    angle = np.linspace(-np.pi / 2, 1.5 * np.pi, 110) + 0.02
    down = (1 + np.sin(angle)) / 2
    x = half * np.cos(angle) * make_interp_spline(WHERE, wider, k=2)(down)
    x[x < 0] *= 0.88 if manner == "lopsided" else 1.0
    whole = np.stack([0.5 + x, TOP + (BOTTOM - TOP) * down], axis=1)
    if manner == "open":
        return [whole[12:-12]]
    return [whole, 0.5 + 1.02 * (whole[5:-20] - 0.5)] if manner == "double" else [whole]


def eyes(manner: str, x: float) -> list[np.ndarray]:
    """Both eyes."""
    strokes = []
    for side in (-1, 1):
        at, y = 0.5 + side * x, 0.46
        lids = [arc(at, y, 0.042, 0.020), arc(at, y, 0.042, -0.014)]
        strokes += {
            "dots": lambda at=at: [ellipse(at, 0.46, 0.008, 0.009)],
            "circles": lambda at=at: [ellipse(at, 0.46, 0.036, 0.036), ellipse(at, 0.46, 0.010, 0.010)],
            "almond": lambda lids=lids: lids,
            "lens": lambda at=at: [arc(at, 0.46, 0.040, 0.010), arc(at, 0.46, 0.040, -0.010)],
            "pupils": lambda at=at, lids=lids: [*lids, ellipse(at, 0.458, 0.014, 0.014)],
            "arcs": lambda at=at: [arc(at, 0.465, 0.040, 0.022)],
            "shut": lambda at=at: [arc(at, 0.455, 0.042, -0.014)],
            "wink": lambda at=at, side=side, lids=lids: [arc(at, 0.46, 0.042, -0.010)] if side > 0 else lids,
        }[manner]()
    return strokes


def brows(manner: str, x: float) -> list[np.ndarray]:
    """Both brows, inner end first."""
    height, bend, slant = {
        "flat": (0.405, 0.004, 0.0),
        "arched": (0.395, 0.018, 0.0),
        "double": (0.395, 0.018, 0.0),
        "raised": (0.355, 0.026, 0.0),
        "angry": (0.405, 0.004, 0.030),
        "worried": (0.390, 0.006, -0.030),
    }[manner]
    strokes = []
    for side in (-1, 1):
        brow = arc(0.5 + side * x, height, 0.055, bend)
        brow[:, 1] -= slant * side * (brow[:, 0] - 0.5 - side * x) / 0.055
        strokes += [brow, brow + np.array([0.002, 0.010])] if manner == "double" else [brow]
    return strokes


def nose(manner: str) -> list[np.ndarray]:
    """A nose."""
    return {
        "hook": [spline([(0.49, 0.48), (0.47, 0.60), (0.50, 0.625), (0.53, 0.61)])],
        "base": [arc(0.5, 0.605, 0.030, -0.018)],
        "long": [spline([(0.485, 0.46), (0.475, 0.58), (0.460, 0.645), (0.50, 0.665), (0.54, 0.645)])],
        "wings": [spline([(0.455, 0.59), (0.445, 0.62), (0.475, 0.625), (0.5, 0.635), (0.525, 0.625), (0.555, 0.62), (0.545, 0.59)])],  # noqa: E501
    }[manner]  # fmt: skip


def mouth(manner: str) -> list[np.ndarray]:
    """A mouth."""
    x, y = 0.5, 0.735
    lower = arc(x, y + 0.002, 0.065, -0.030)
    return {
        "flat": [arc(x, y, 0.070, 0.0)],
        "smirk": [arc(x, y - 0.008, 0.070, -0.014)],
        "smile": [arc(x, y - 0.015, 0.085, -0.032)],
        "grin": [arc(x, y - 0.025, 0.115, -0.055)],
        "frown": [arc(x, y + 0.012, 0.075, 0.030)],
        "snarl": [arc(x, y + 0.008, 0.080, 0.018)],
        "skewed": [spline([(0.435, 0.735), (0.49, 0.742), (0.575, 0.712)])],
        "o": [ellipse(x, y + 0.01, 0.035, 0.045)],
        "tall_o": [ellipse(x, y + 0.015, 0.045, 0.075)],
        "laugh": [np.concatenate([arc(x, y - 0.02, 0.095, -0.006), arc(x, y - 0.02, 0.095, -0.080)[::-1]])],
        "teeth": [arc(x, y - 0.02, 0.105, -0.004), arc(x, y - 0.02, 0.105, -0.085), arc(x, y + 0.005, 0.090, -0.008)],
        "full_lips": [
            arc(x, y, 0.065, 0.0),
            spline([(0.435, y), (0.475, y - 0.024), (0.5, y - 0.016), (0.525, y - 0.024), (0.565, y)]),
            lower,
        ],
        "parted": [arc(x, y, 0.060, 0.018), arc(x, y, 0.060, -0.030)],
        "rectangle": [np.array([(0.43, 0.70), (0.57, 0.70), (0.56, 0.80), (0.44, 0.80), (0.43, 0.70)])],
    }[manner]


def extra(manner: str, x: float, half: float) -> list[np.ndarray]:
    """Strokes that are no line of the head, and ears."""
    ears = [spline([(0.5 + s * (half - 0.005), 0.43), (0.5 + s * (half + 0.045), 0.42), (0.5 + s * (half + 0.04), 0.52), (0.5 + s * (half - 0.01), 0.57)]) for s in (-1, 1)]  # noqa: E501  # fmt: skip
    bridge = np.array([(0.455, 0.455), (0.545, 0.455)])
    return {
        "ears": ears,
        "hair": [spline([(0.24, 0.40), (0.27, 0.16), (0.50, 0.04), (0.73, 0.16), (0.76, 0.40)], 70), spline([(0.35, 0.13), (0.50, 0.22), (0.66, 0.14)])],  # noqa: E501
        "beard": [spline([(0.5 + dx, 0.79), (0.5 + dx + 0.008, 0.83), (0.5 + dx - 0.004, 0.87)], 9) for dx in (-0.12, -0.07, -0.02, 0.03, 0.08, 0.12)],  # noqa: E501
        "glasses": [ellipse(0.5 - x, 0.46, 0.062, 0.055), ellipse(0.5 + x, 0.46, 0.062, 0.055), bridge],
        "tears": [np.array([(0.5 + s * x, 0.50), (0.5 + s * (x + 0.006), 0.56)]) for s in (-1, 1)],
        "furrows": [np.array([(0.5 + s * 0.012, 0.385), (0.5 + s * 0.010, 0.425)]) for s in (-1, 1)],
        "wrinkles": [arc(0.5, 0.30, 0.085, 0.006), arc(0.5, 0.33, 0.090, 0.006), spline([(0.44, 0.62), (0.41, 0.68), (0.405, 0.73)]), spline([(0.56, 0.62), (0.59, 0.68), (0.595, 0.73)])],  # noqa: E501
    }[manner]  # fmt: skip


def placed(points: np.ndarray, manner: set[str]) -> np.ndarray:
    """A line where the whole drawing stands on the canvas."""
    if "tilted" in manner:
        cos, sin = np.cos(0.12), np.sin(0.12)
        points = 0.5 + (points - 0.5) @ np.array([[cos, sin], [-sin, cos]])
    if "moved" in manner:
        points = 0.75 * points + [0.22, 0.02]
    return 0.4 * points + [0.1, 0.5] if "small" in manner else points


def unsteady(points: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A line with the slow sway and the slight misplacement of a hand."""
    along = np.linspace(0, 1, len(points))[:, None]
    sway = sum(random.normal(0, 0.0016 / k, 2) * np.sin(np.pi * k * along + random.uniform(0, 6)) for k in (1, 2, 3))
    return points + sway + random.normal(0, 0.002, 2)


def main() -> None:
    """Write the drawings and what they mean beside the twelve."""
    meanings = json.loads(MEANINGS.read_text()) if MEANINGS.exists() else {}
    for line in FACES.split("\n")[1:-1]:
        number, name, shape, drawn, eye, brow, nosed, mouthed, extras, *means = line.split()
        random, half = np.random.default_rng(int(number)), OUTLINES[shape][0]
        x = 0.36 * half + 0.015
        strokes = outline(shape, drawn) + eyes(eye, x)
        strokes += brows(brow, x) if brow != "none" else []
        strokes += nose(nosed) if nosed != "none" else []
        strokes += mouth(mouthed) if mouthed != "none" else []
        further = set(extras.split(",")) - {"-"}
        for kind in sorted(further - {"moved", "small", "tilted"}):
            strokes += extra(kind, x, half)
        lines = [placed(unsteady(stroke, random), further).clip(0.002, 0.998) for stroke in strokes]
        sw.Sketch.from_strokes([np.round(one, 4) for one in lines]).save(FOLDER / f"{number}_{name}.json")
        meanings[f"{number}_{name}"] = means
    MEANINGS.write_text(json.dumps(meanings, indent=0, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
