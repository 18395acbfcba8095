"""The lines of a face sketch: their names, their kinds and the colours they are shown in.

Left and right are the subject's. The three kinds are those of the paper's section 3 (Figure 3); a freehand stroke whose
line is not known yet is of a fourth, "unnamed". Users add kinds of their own.
"""

from __future__ import annotations

import re

SILHOUETTE = "silhouette"
FEATURES = (
    "left_brow",
    "right_brow",
    "left_eye_upper",
    "left_eye_lower",
    "right_eye_upper",
    "right_eye_lower",
    "mouth_upper",
    "mouth_lower",
    "left_ear",
    "right_ear",
    "nose",
)
WRINKLE = "wrinkle"
UNNAMED = "unnamed"
LINE_NAMES = (SILHOUETTE, *FEATURES, WRINKLE, UNNAMED)

COLOURS = {"silhouette": "#d62728", "feature": "#1f5fd0", "wrinkle": "#000000", "unnamed": "#444444"}

_KINDS = {SILHOUETTE: "silhouette", **dict.fromkeys(FEATURES, "feature"), WRINKLE: "wrinkle", UNNAMED: "unnamed"}
_ADDED: set[str] = set()


def kind(name: str) -> str:
    """The kind of a line: "silhouette", "feature", "wrinkle", "unnamed", or its own name if it was registered.

    Raises
    ------
    ValueError
        If no line has this name.
    """
    if not isinstance(name, str) or name not in _KINDS:
        raise ValueError(f"a line is one of {', '.join(_KINDS)}; given {name!r}")
    return _KINDS[name]


def register_line(name: str, colour: str) -> None:
    """Add a kind of line, or give one that was added another colour, in all drawings from now on.

    No stroke becomes one by itself: what infers a drawing gives strokes their names. A drawing saved with such lines
    needs them registered when it is loaded.

    Parameters
    ----------
    name : str
        Also the name of its kind.
    colour : str
        Of its ink, as "#rrggbb".

    Raises
    ------
    ValueError
        If the name is none or one of the house's own, or the colour is written otherwise.

    Examples
    --------
    >>> sw.register_line("moustache", "#8a5a00")
    >>> "#8a5a00" in sw.Sketch.from_strokes([[[0.4, 0.6], [0.6, 0.6]]]).renamed(["moustache"]).svg()
    True
    """
    taken = {*LINE_NAMES, *COLOURS} - _ADDED
    if not isinstance(name, str) or not name.isidentifier() or name in taken:
        raise ValueError(f"a line kind has a name of its own, of letters, digits and underscores; given {name!r}")
    if not isinstance(colour, str) or not re.fullmatch("#[0-9a-fA-F]{6}", colour):
        raise ValueError(f'a colour is written "#rrggbb"; given {colour!r}')
    _ADDED.add(name)
    _KINDS[name] = name
    COLOURS[name] = colour
