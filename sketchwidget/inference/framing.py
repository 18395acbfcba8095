"""Place and size of a drawing on the canvas, taken from its outline."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

from ..geometry.view import CANVAS_MM, View

OUTLINE_SIZE = 0.70  # square root of the outline's width times height in the normalised drawing: that of the mean face
_PLACING_STEPS = 6


@dataclass(frozen=True)
class Frame:
    """How a drawing becomes the normalised one that the networks see: ``scale * points + offset``.

    Parameters
    ----------
    scale : float
    offset : (2,) array
    """

    scale: float = 1.0
    offset: np.ndarray | tuple[float, float] = (0.0, 0.0)

    @classmethod
    def of_outline(cls, points: np.ndarray) -> Frame:
        """The frame that centres an outline (n, 2) and gives it its normal size.

        Raises
        ------
        ValueError
            If the outline has no width or no height.
        """
        low, high = points.min(axis=0), points.max(axis=0)
        size = float(np.sqrt(np.prod(high - low)))
        if size == 0:
            raise ValueError("an outline has width and height")
        scale = OUTLINE_SIZE / size
        return cls(scale, 0.5 - scale * (low + high) / 2)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the drawing in the normalised one."""
        return self.scale * points + np.asarray(self.offset, dtype=np.float32)


def place(head: np.ndarray, drawn: np.ndarray) -> View:
    """The front view that puts a head's outline onto a drawn one: scale and position in least squares, to the
    nearest points.

    Parameters
    ----------
    head : (n, 2) array
        The head's outline in the canonical front view.
    drawn : (m, 2) array
        The drawn outline; it may be open at the top.
    """
    low, high = head.min(axis=0), head.max(axis=0)
    drawn_low, drawn_high = drawn.min(axis=0), drawn.max(axis=0)
    # Start from what a U-shaped outline and a closed one have in common: width, and the chin.
    scale = (drawn_high[0] - drawn_low[0]) / (high[0] - low[0])
    offset = np.array(
        [(drawn_low[0] + drawn_high[0] - scale * (low[0] + high[0])) / 2, drawn_high[1] - scale * high[1]]
    )
    drawn_middle = drawn.mean(axis=0)
    drawn_centred = drawn - drawn_middle
    found = np.zeros(0)
    for _ in range(_PLACING_STEPS):
        former, found = found, cdist((drawn - offset) / scale, head, "sqeuclidean").argmin(axis=1)
        if np.array_equal(found, former):
            break
        nearest = head[found]
        middle = nearest.mean(axis=0)
        centred = nearest - middle
        scale = float((centred * drawn_centred).sum() / (centred**2).sum())
        offset = drawn_middle - scale * middle
    return View(scale=scale / CANVAS_MM, centre=scale * 0.5 + offset)
