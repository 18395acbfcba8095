"""The shapes of the gestures, as nobody draws them: each with what may vary from writer to writer.

All are polylines (n, 2) about as large as 1, x right and y down as on the canvas.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

_PER_TURN = 48  # points of a loop


def line(angle: float = 0.0, sag: float = 0.0) -> np.ndarray:
    """A line of length 1 that starts at the origin.

    Parameters
    ----------
    angle : float
        Its direction, radians from the x axis downwards.
    sag : float
        How far its middle is off the straight way.
    """
    t = np.linspace(0.0, 1.0, 24)
    return turned(np.stack([t, 4 * sag * t * (1 - t)], axis=1), angle)


def region(
    aspect: float = 0.8, bumps: Sequence[float] | np.ndarray = (), start: float = 0.0, extent: float = 1.0
) -> np.ndarray:
    """A closed loop about the origin.

    Parameters
    ----------
    aspect : float
        Height over width.
    bumps : sequence of float
        Amplitudes of what the radius has of cos 2t, sin 2t, cos 3t, sin 3t, ... above that of an ellipse.
    start : float
        Where it begins, in turns.
    extent : float
        How much of a turn is drawn: 1 is a loop whose ends meet, more one whose ends overlap.
    """
    turn = 2 * np.pi * (start + extent * np.linspace(0.0, 1.0, 2 * _PER_TURN))
    radius = 0.5 * np.ones_like(turn)
    for place, bump in enumerate(bumps):
        radius += 0.5 * bump * (np.sin if place % 2 else np.cos)((2 + place // 2) * turn)
    return radius[:, None] * np.stack([np.cos(turn), aspect * np.sin(turn)], axis=1)


def arrow(
    shaft: float = 1.0,
    barbs: tuple[float, float] = (0.4, 0.4),
    angles: tuple[float, float] = (0.7, 0.7),
    closed_head: bool = False,
) -> np.ndarray:
    """An arrow to the right with its tip at the origin: shaft, one barb, back to the tip, the other barb.

    Parameters
    ----------
    shaft : float
        Its length; with 0 it is a bare chevron.
    barbs : tuple of float
        Lengths of the first and the second barb.
    angles : tuple of float
        Between shaft and barb, radians; the first barb goes up for positive ones.
    closed_head : bool
        Whether the pen goes straight from the end of one barb to that of the other.
    """
    (first, second), (up, down) = barbs, angles
    ends = [
        [-first * np.cos(up), -first * np.sin(up)],
        [-second * np.cos(down), second * np.sin(down)],
    ]
    tip = [0.0, 0.0]
    head = [ends[0], ends[1]] if closed_head and shaft else [ends[0], tip, ends[1]]
    return np.array([[-shaft, 0.0], tip, *head] if shaft else head)


def roll(
    loops: int,
    heights: Sequence[float] | np.ndarray = (),
    widths: Sequence[float] | np.ndarray = (),
    advance: float = 0.6,
    flat: float = 0.0,
    lead: tuple[float, float] = (0.25, 0.25),
) -> np.ndarray:
    """Loops that stand on a line, drawn from left to right as a cursive e: a prolate trochoid.

    Parameters
    ----------
    loops : int
    heights, widths : sequence of float
        Of each loop; by default all are 1 high and 0.6 wide.
    advance : float
        From a loop to the next.
    flat : float
        Of that, how much is drawn as a straight line between the loops.
    lead : tuple of float
        How much of a turn is drawn before the first loop's foot, and after the last's.
    """
    heights = np.asarray(heights) if len(heights) else np.ones(loops)
    widths = np.asarray(widths) if len(widths) else 0.6 * np.ones(loops)
    before, after = lead
    turn = np.linspace(-before, loops + after, int((loops + before + after) * _PER_TURN))
    centres = np.arange(loops) + 0.5
    height, width = np.interp(turn, centres, heights), np.interp(turn, centres, widths)
    x = advance * turn + width / 2 * np.sin(2 * np.pi * turn)
    y = -height / 2 * (1 - np.cos(2 * np.pi * turn))
    x += flat * np.clip(np.floor(turn), 0, loops - 1)
    return np.stack([x, y], axis=1)


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    """Points turned about the origin, from the x axis towards the y axis."""
    cos, sin = np.cos(angle), np.sin(angle)
    return points @ np.array([[cos, sin], [-sin, cos]])


EXAMPLES = {
    "line": line(-0.5),
    "region": region(0.75, (0.06, 0.04, 0.03), 0.7, 1.02),
    "left arrow": arrow() * [-1, 1],
    "right arrow": arrow(),
    **{f"up roll {n}": roll(n) for n in (1, 2, 3)},
    **{f"down roll {n}": roll(n) * [1, -1] for n in (1, 2, 3)},
}


def example(name: str, middle: np.ndarray, size: float) -> np.ndarray:
    """The example (n, 2) of a gesture about a place, its longer side so long.

    Raises
    ------
    KeyError
        If there is no such gesture.
    """
    shape = EXAMPLES[name]
    low, high = shape.min(axis=0), shape.max(axis=0)
    return np.asarray(middle) + (shape - (low + high) / 2) * size / (high - low).max()
