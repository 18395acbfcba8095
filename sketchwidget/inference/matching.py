"""Which drawn points lie on which line of a face: strokes matched to projected curves, whole, split or merged."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

from ..sketch import FEATURES, SILHOUETTE, resample_each
from .chain import Chain, around, halves, is_closed
from .shape_code import POINTS, ShapeModel, split_lines
from .soft_limit import soft_limit

# Lines that one stroke may draw together: an ellipse is two eye contours, one line a closed mouth.
GROUPS = {
    SILHOUETTE: SILHOUETTE,
    **{name: name.removesuffix("_upper").removesuffix("_lower") for name in FEATURES},
}

_AT = split_lines(np.arange(POINTS))  # where the points of each line are among those of the shape model

# Which points of the shape model belong to the lines that may be one stroke.
PLACES = {
    group: np.concatenate([at for name, at in _AT.items() if GROUPS[name] == group])
    for group in dict.fromkeys(GROUPS.values())
}

_OUTLINE_INK, _FEATURE_INK = 400, 50  # points of a stroke
_REACH = 0.03  # canvas units: a point this far from its stroke counts half
_FARTHEST = 0.12  # beyond this it does not count
_EYES = [group for group in PLACES if "eye" in group]
# What is drawn whole if at all: its middle is that of the line.
_PLACED_WHOLE = [group for group in PLACES if any(part in group for part in ("brow", "eye", "mouth", "ear"))]
_MARK = 0.5  # of the breadth of an eye: what is smaller is a pupil or a dot, which shows where the eye is and no lids
_ROUNDS = 2
_CODE_LIMIT = (2.0, 3.0)  # standard deviations that coefficients may go to freely, and at most


class DrawnLines:
    """The strokes of a drawing by the line that they were named after, ready to be matched.

    Parameters
    ----------
    strokes : sequence of (k, 2) arrays
    names : sequence of str
        The line that each stroke was named after; those of other names are left out.
    """

    def __init__(self, strokes: Sequence[np.ndarray], names: Sequence[str]) -> None:
        self._strokes: dict[str, list[np.ndarray]] = {}
        for stroke, name in zip(strokes, names, strict=True):
            if name in GROUPS:
                self._strokes.setdefault(name, []).append(np.asarray(stroke))
        ink: dict[str, list[np.ndarray]] = {}
        for outline in (True, False):
            chosen = [(name, of) for name, of in self._strokes.items() if (name == SILHOUETTE) == outline]
            every = [stroke for _, of in chosen for stroke in of]
            dense = iter(resample_each(every, _OUTLINE_INK if outline else _FEATURE_INK))
            for name, of in chosen:
                ink.setdefault(GROUPS[name], []).extend(next(dense) for _ in of)
        self._ink = {group: _Ink.of(np.concatenate(lines)) for group, lines in ink.items()}

    @classmethod
    def of_points(cls, points: np.ndarray, seen: np.ndarray) -> DrawnLines:
        """Those seen (n,) of a drawing's points (n, 2), in the order of `sample`; what is not seen parts strokes."""
        strokes, names = [], []
        for name, line in split_lines(points).items():
            drawn = split_lines(seen)[name]
            runs = np.split(line, np.flatnonzero(np.diff(drawn.astype(int))) + 1)
            runs = runs[0 if drawn[0] else 1 :: 2]
            if name == SILHOUETTE and drawn.all():
                runs = [np.concatenate([line, line[:1]])]
            strokes += runs
            names += [name] * len(runs)
        return cls(strokes, names)

    def without_ears(self) -> DrawnLines:
        """All of them but the ears."""
        others = copy.copy(self)
        others._ink = {group: ink for group, ink in self._ink.items() if not group.endswith("ear")}
        others._strokes = {name: strokes for name, strokes in self._strokes.items() if not name.endswith("ear")}
        return others

    def match(self, points: np.ndarray, settled: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """The drawn point for each point of a face's lines.

        Parameters
        ----------
        points : (n, 2) array
            As `sketchwidget.inference.shape_code.sample` gives them, in the frame of the strokes.
        settled : bool
            Whether the points are near their strokes already; otherwise each feature is moved onto its strokes first.
            Eyes always are.

        Returns
        -------
        drawn : (n, 2) array
            The nearest point of a stroke with the line's name, or of its partner's; the point itself where there is
            none. An eye that is a dot keeps its shape and goes there.
        weight : (n,) array
            How much it counts, from 0 to 1.
        """
        drawn, squares = np.array(points, dtype=np.float64), np.full(len(points), np.inf)
        for group, ink in self._ink.items():
            at = PLACES[group]
            here = _placed(points[at], group, ink, settled)
            if ink.marks(here, group):
                drawn[at], squares[at] = here, 0.0
            else:
                drawn[at], squares[at] = ink.nearest(here)
        return drawn, _weight(squares)

    def along(self, points: np.ndarray, settled: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """The drawn point for each point of a face's lines at equal shares of the length, as `match` has them.

        What is missing at the end of a line has no weight. Where strokes are drawn over each other, or an outline is
        open, it is the nearest point.
        """
        drawn, squares = np.array(points, dtype=np.float64), np.full(len(points), np.inf)
        for group, ink in self._ink.items():
            at = PLACES[group]
            drawn[at] = _placed(points[at], group, ink, settled)
            if ink.marks(drawn[at], group):
                squares[at] = 0.0
                continue
            for name, strokes in self._strokes_of(group, drawn):
                line = drawn[_AT[name]]
                drawn[_AT[name]], squares[_AT[name]] = _by_length(name, strokes, line) or ink.nearest(line)
        return drawn, _weight(squares)

    def _strokes_of(self, group: str, points: np.ndarray) -> Iterator[tuple[str, list[np.ndarray]]]:
        """The strokes of each line of a group; of an ellipse either half, and of two lines drawn as one that one."""
        names = [name for name in _AT if GROUPS[name] == group]
        every = [stroke for name in names for stroke in self._strokes.get(name, ())]
        own = {name: self._strokes.get(name, every) for name in names}
        if len(names) > 1 and len(every) == 1 and is_closed(every[0]):
            ends = points[_AT[names[0]]][[0, -1]]
            own = dict(zip(names, ([half] for half in halves(every[0], ends[1] - ends[0])), strict=True))
        yield from own.items()


def _placed(points: np.ndarray, group: str, ink: _Ink, settled: bool) -> np.ndarray:
    """Points (k, 2) of a group, moved onto its strokes unless they are near them already."""
    # Of lids it is easily the wrong one that is nearest.
    if group in _EYES or (not settled and group in _PLACED_WHOLE):
        return points + ink.middle - _middle(points)
    return points


def _by_length(name: str, strokes: list[np.ndarray], line: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Points (k, 2) of strokes for those of their line and their squared distances; None if nothing tells which."""
    if name == SILHOUETTE:
        if len(strokes) > 1 or not is_closed(strokes[0]):
            return None
        found, seen = around(strokes[0], line), True
    elif (chain := Chain.of(strokes, line)) is not None:
        found, seen = chain.along(line)
    else:
        return None
    return found, np.where(seen, ((found - line) ** 2).sum(axis=1), np.inf)


def _weight(squares: np.ndarray) -> np.ndarray:
    return np.where(squares < _FARTHEST**2, 1 / (1 + squares / _REACH**2), 0.0)


@dataclass(frozen=True)
class _Ink:
    """What is drawn of lines that may be one stroke: points (n, 2), the middle of their box and its longer side."""

    points: np.ndarray
    middle: np.ndarray
    breadth: float

    @classmethod
    def of(cls, points: np.ndarray) -> _Ink:
        return cls(points, _middle(points), np.ptp(points, axis=0).max())

    def marks(self, here: np.ndarray, group: str) -> bool:
        """Whether it only marks where an eye is whose points are `here` (k, 2)."""
        return group in _EYES and self.breadth < _MARK * np.ptp(here, axis=0).max()

    def nearest(self, here: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The nearest of its points to some (k, 2), and their squared distances (k,)."""
        apart = cdist(here, self.points, "sqeuclidean")  # of so few points quicker than a tree
        nearest = apart.argmin(axis=1)
        return self.points[nearest], apart[np.arange(len(here)), nearest]


def shape_code(model: ShapeModel, points: np.ndarray, drawn: DrawnLines) -> np.ndarray:
    """A drawing's lines as `ShapeModel.describe` has them (p + q + 2 n,), from a guess of where they are.

    Coefficients go no further than those of heads do; what is left of the points is what they left before that.

    Parameters
    ----------
    model : ShapeModel
    points : (n, 2) array
        The guess: the lines of an inferred face in the normalised frame.
    drawn : DrawnLines
        In that frame.
    """
    for turn in range(_ROUNDS):
        found, weight = drawn.along(points, settled=turn > 0)
        code = model.encode(found[None], weight[None])
        points = model.decode(code)[0]
    left_over = model.left_over(code, found[None], weight[None])
    return np.concatenate([soft_limit(code, *_CODE_LIMIT), left_over], axis=1)[0]


def _middle(points: np.ndarray) -> np.ndarray:
    return (points.min(axis=0) + points.max(axis=0)) / 2
