"""The profile as an editable line of the side views (paper 3.3, after Nealen et al. 2007)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from sketchwidget.geometry.view import View
from sketchwidget.sketch import arc_length, resample

if TYPE_CHECKING:
    from .modeller import Modelled

_NEAR = 0.12  # canvas units: a stroke further from the profile means something else
_FREE = 0.06  # canvas units of the profile beyond the stroke's ends that may give way
_STROKE_POINTS = 200


def side_view(frame: View, side: str) -> View:
    """The view of the head from its left or right side that fits a front view."""
    return View(View.preset(side).rotation, frame.scale, frame.centre)


def in_head(points: np.ndarray, frame: View) -> np.ndarray:
    """Canvas points (p, 2) of the left view as z and y in millimetres."""
    return (points - frame.centre) / frame.scale * [-1, -1]


def drawn(shown: Modelled, side: str = "left") -> np.ndarray:
    """The profile (p, 2) of a head on the canvas of a side view."""
    face = shown.face
    return side_view(shown.frame, side).project(face.vertices[face.model.handles.profile])


def dragged(former: np.ndarray | None, shown: Modelled, stroke: np.ndarray, side: str) -> np.ndarray:
    """Where the profile was drawn, once a stroke near it has dragged it along.

    The points of the profile between the two nearest to the ends of the stroke go to the stroke, by arc length. A
    little way beyond them the profile is free to give way; all the rest keeps its place.

    Parameters
    ----------
    former : (p, 2) array or None
        Where it was drawn before, on the canvas of the left view.
    shown : Modelled
        The head on show.
    stroke : (n, 2) array
        On the canvas of the side view.
    side : str
        "left" or "right".

    Raises
    ------
    ValueError
        If the stroke is nowhere near the profile, or a dot.
    """
    centre = float(shown.frame.centre[0])
    line = np.asarray(stroke, dtype=np.float64)
    if side == "right":
        line = np.stack([2 * centre - line[:, 0], line[:, 1]], axis=1)
    present = drawn(shown)
    along = arc_length(present)
    distance, nearest = map(np.asarray, KDTree(present).query(line[[0, -1]]))
    if distance.max() > _NEAR:
        raise ValueError("the stroke is not near the profile: draw it beside the part that it should drag")
    if nearest[0] > nearest[1]:
        line, nearest = line[::-1], nearest[::-1]
    first, last = map(int, nearest)
    if last - first < 2 or arc_length(line)[-1] < 1e-3:
        raise ValueError("the stroke is too short to drag the profile: draw along the part that it should drag")
    targets = present.astype(np.float64) if former is None else former.copy()
    where = np.interp(along[first : last + 1], along[[first, last]], [0.0, 1.0])
    even = resample(line, _STROKE_POINTS)
    shares = np.linspace(0.0, 1.0, _STROKE_POINTS)
    free = (along > along[first] - _FREE) & (along < along[last] + _FREE)
    targets[free] = np.nan
    for axis in range(2):
        targets[first : last + 1, axis] = np.interp(where, shares, even[:, axis])
    return targets
