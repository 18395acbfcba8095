"""The ten gestures of the refinement mode (DeepSketch2Face, section 3.3 and Figure 4)."""

from __future__ import annotations

LINE, REGION, LEFT_ARROW, RIGHT_ARROW = "line", "region", "left arrow", "right arrow"
ARROWS = (LEFT_ARROW, RIGHT_ARROW)
LEVELS = (1, 2, 3)  # of bulging and of depression: as many loops as a roll has
UP_ROLLS = tuple(f"up roll {level}" for level in LEVELS)
DOWN_ROLLS = tuple(f"down roll {level}" for level in LEVELS)

GESTURES = (LINE, REGION, *ARROWS, *UP_ROLLS, *DOWN_ROLLS)
