"""The lines of a face sketch: their names, their kinds and the colours they are shown in.

Left and right are the subject's. The three kinds are those of the paper's section 3 (Figure 3); a freehand stroke whose
line is not known yet is of a fourth, "unnamed".
"""

from __future__ import annotations

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


def kind(name: str) -> str:
    """The kind of a line: "silhouette", "feature", "wrinkle" or "unnamed".

    Raises
    ------
    ValueError
        If no line has this name.
    """
    if not isinstance(name, str) or name not in _KINDS:
        raise ValueError(f"a line is one of {', '.join(LINE_NAMES)}; given {name!r}")
    return _KINDS[name]
