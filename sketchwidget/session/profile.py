"""The profile as an editable line of the side views (paper 3.3, after Nealen et al. 2007)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from sketchwidget.geometry.view import View
from sketchwidget.sketch import arc_length, resample
from sketchwidget.sketch.crossing import without_loops

if TYPE_CHECKING:
    from .modeller import Modelled

_NEAR = 0.12  # canvas units: a stroke further from the profile means something else
_FREE = 0.06  # canvas units of the profile beyond the stroke's ends that may give way
_STROKE_POINTS = 200
_LONGEST = 4.0  # times the part of the profile that it drags


def side_view(frame: View, side: str) -> View:
    """The view of the head from its left or right side that fits a front view.

    Raises
    ------
    ValueError
        If the side is another.
    """
    if side not in ("left", "right"):
        raise ValueError(f"a profile is seen from the left or the right; given {side!r}")
    return View(View.preset(side).rotation, frame.scale, frame.centre)


@dataclass(frozen=True, eq=False)
class Dragged:
    """What was drawn of the profile.

    Parameters
    ----------
    depth : (p,) array
        z in millimetres of the points that were drawn; NaN for the others.
    rise : (p,) array
        Millimetres by which they were drawn above where the lines of the front view alone would have them; NaN for the
        others.
    free : (p,) bool array
        Which of the others give way; the rest keeps its place beside what is drawn in front.
    """

    depth: np.ndarray
    rise: np.ndarray
    free: np.ndarray

    def moves(self, below: np.ndarray) -> np.ndarray:
        """Displacements (p, 2) in depth and height of the points (p, 3) of a head below; NaN for what is free."""
        moves = np.stack([self.depth - below[:, 2], self.rise], axis=1)
        moves[np.isnan(self.depth) & ~self.free] = 0.0
        return moves


def drawn(shown: Modelled, side: str = "left") -> np.ndarray:
    """The profile (p, 2) of a head on the canvas of a side view."""
    face = shown.face
    return side_view(shown.frame, side).project(face.vertices[face.model.handles.profile])


def dragged(former: Dragged | None, shown: Modelled, lined: Modelled, stroke: np.ndarray, side: str) -> Dragged:
    """What is drawn of the profile, once a stroke near it has dragged it along.

    The points of the profile between the two nearest to the ends of the stroke go to the stroke, by arc length. A
    little way beyond them the profile is free to give way; all the rest keeps its place.

    Parameters
    ----------
    former : Dragged or None
        What was drawn of it before.
    shown : Modelled
        The head on show.
    lined : Modelled
        The head that the lines of the front view alone give.
    stroke : (n, 2) array
        On the canvas of the side view.
    side : str
        "left" or "right".

    Raises
    ------
    ValueError
        If the stroke is not along the profile: a dot, a loop, far away or far too long.
    """
    frame = shown.frame
    line = without_loops(resample(stroke, _STROKE_POINTS).astype(np.float64))
    if side == "right":
        line = np.stack([2 * frame.centre[0] - line[:, 0], line[:, 1]], axis=1)
    present = drawn(shown)
    along = arc_length(present)
    distance, nearest = map(np.asarray, KDTree(present).query(line))
    if distance.max() > _NEAR:
        raise ValueError("the stroke is not near the profile: draw it beside the part that it should drag")
    first, last = map(int, nearest[[0, -1]])
    if first > last:
        line, first, last = line[::-1], last, first
    if last - first < 2 or arc_length(line)[-1] < 1e-3:
        raise ValueError("the stroke is too short to drag the profile: draw along the part that it should drag")
    if arc_length(stroke)[-1] > _LONGEST * (along[last] - along[first]):
        raise ValueError("the stroke is far longer than the part of the profile that it drags: draw along it once")
    shares = arc_length(line) / arc_length(line)[-1]
    where = np.interp(along[first : last + 1], along[[first, last]], [0.0, 1.0])
    there = np.stack([np.interp(where, shares, line[:, axis]) for axis in range(2)], axis=1)
    depth, height = ((there - frame.centre) / frame.scale * [-1, -1]).T
    part = slice(first, last + 1)
    nowhere = np.full(len(present), np.nan)
    depths, rises = (nowhere, nowhere.copy()) if former is None else (former.depth.copy(), former.rise.copy())
    free = np.zeros(len(present), dtype=bool) if former is None else former.free.copy()
    beside = (along > along[first] - _FREE) & (along < along[last] + _FREE)
    depths[beside] = rises[beside] = np.nan
    free[beside] = True
    free[part] = False
    depths[part] = depth
    rises[part] = height - lined.face.vertices[lined.face.model.handles.profile[part], 1]
    return Dragged(depths, rises, free)
