"""Which drawn points lie on which line of a face: strokes matched to projected curves, whole, split or merged."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

from ..sketch import FEATURES, SILHOUETTE, resample_each
from .chain import Chains, around, halves, in_order, is_closed
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
_EYES = np.array(["eye" in group for group in PLACES])
# What is drawn whole if at all: its middle is that of the line.
_PLACED_WHOLE = np.array([any(part in group for part in ("brow", "eye", "mouth", "ear")) for group in PLACES])
# All points, group after group, where each group begins among them, and which one each point is of.
_SORTED = np.concatenate(list(PLACES.values()))
_BEGINS = np.cumsum([0, *map(len, PLACES.values())])[:-1]
_GROUP = np.repeat(np.arange(len(PLACES)), [len(at) for at in PLACES.values()])[_SORTED.argsort()]
_EYES_AND_MOUTH = _EYES | np.array(["mouth" in group for group in PLACES])
_MARK = 0.5  # of the breadth of an eye or a mouth: what is smaller is a dot, which shows where it is and not its shape
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
        drawn: dict[str, list[np.ndarray]] = {}
        for stroke, name in zip(strokes, names, strict=True):
            if name in GROUPS:
                drawn.setdefault(name, []).append(np.asarray(stroke))
        ink: dict[str, list[np.ndarray]] = {}
        for outline in (True, False):
            chosen = [(name, of) for name, of in drawn.items() if (name == SILHOUETTE) == outline]
            every = [stroke for _, of in chosen for stroke in of]
            dense = iter(resample_each(every, _OUTLINE_INK if outline else _FEATURE_INK))
            for name, of in chosen:
                ink.setdefault(GROUPS[name], []).extend(next(dense) for _ in of)
        self._keep(drawn, {group: _Ink.of(np.concatenate(lines)) for group, lines in ink.items()})

    def _keep(self, strokes: dict[str, list[np.ndarray]], ink: dict[str, _Ink]) -> None:
        self._strokes, self._ink = strokes, ink
        self._middles = np.array([ink[group].middle if group in ink else (np.nan, np.nan) for group in PLACES])
        self._breadths = np.array([ink[group].breadth if group in ink else np.inf for group in PLACES])

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

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._ink)

    def ears(self) -> DrawnLines:
        """The ears alone."""
        return self._only(ears=True)

    def without_ears(self) -> DrawnLines:
        """All of them but the ears."""
        return self._only(ears=False)

    def _only(self, ears: bool) -> DrawnLines:
        some = copy.copy(self)
        some._keep(
            {name: strokes for name, strokes in self._strokes.items() if name.endswith("ear") == ears},
            {group: ink for group, ink in self._ink.items() if group.endswith("ear") == ears},
        )
        return some

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
            none. An eye or a mouth that is a dot keeps its shape and goes there.
        weight : (n,) array
            How much it counts, from 0 to 1.
        """
        beside, marked = self.beside(points, settled)
        drawn, squares = self.nearest(beside, marked)
        return drawn, _weight(squares)

    def beside(self, points: np.ndarray, settled: bool) -> tuple[np.ndarray, np.ndarray]:
        """Points (n, 2) moved onto their strokes unless near already, and which (n,) are of eyes and mouths that are
        dots.
        """
        low, high = (most.reduceat(points[_SORTED], _BEGINS) for most in (np.minimum, np.maximum))
        # Of lids it is easily the wrong one that is nearest.
        moved = _EYES if settled else _PLACED_WHOLE
        by = np.where(moved[:, None] & np.isfinite(self._middles), self._middles - (low + high) / 2, 0.0)
        marked = _EYES_AND_MOUTH & (self._breadths < _MARK * (high - low).max(axis=1))
        return points + by[_GROUP], marked[_GROUP]

    def nearest(self, beside: np.ndarray, known: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The drawn points (n, 2) nearest to some that are beside them, and their squared distances (n,).

        Where all points of a feature are known (n,), they stay.
        """
        drawn, squares = beside.copy(), np.where(known, 0.0, np.inf)
        for group, ink in self._ink.items():
            at = PLACES[group]
            if not known[at].all():
                apart = cdist(beside[at], ink.points, "sqeuclidean")  # of so few points quicker than a tree
                nearest = apart.argmin(axis=1)
                drawn[at], squares[at] = ink.points[nearest], apart[np.arange(len(at)), nearest]
        return drawn, squares

    def by_line(self, beside: np.ndarray) -> dict[str, list[np.ndarray]]:
        """The strokes of each line: an ellipse is two halves, and what is drawn of one of two partners is both.

        Parameters
        ----------
        beside : (n, 2) array
            See `beside`.
        """
        own: dict[str, list[np.ndarray]] = {}
        for group in self._ink:
            names = [name for name in _AT if GROUPS[name] == group]
            every = [stroke for name in names for stroke in self._strokes.get(name, ())]
            own |= {name: self._strokes.get(name, every) for name in names}
            if len(names) > 1 and len(every) == 1 and is_closed(every[0]):
                first, *_, last = beside[_AT[names[0]]]
                own |= {name: [half] for name, half in zip(names, halves(every[0], last - first), strict=True)}
        return own


class OrderedLines:
    """Drawn lines of which it is known where they begin and which way they run, so that shares of length tell points.

    Parameters
    ----------
    lines : DrawnLines
    points : (n, 2) array
        Of a face's lines as `DrawnLines.match` takes them: beside these, strokes are put in their order.
    """

    def __init__(self, lines: DrawnLines, points: np.ndarray) -> None:
        self._lines = lines
        beside, marked = lines.beside(points, settled=False)
        own = lines.by_line(beside)
        outline = own.pop(SILHOUETTE, [])
        self._outline = outline[0] if len(outline) == 1 and is_closed(outline[0]) else None
        chains = {name: in_order(own[name], beside[_AT[name]]) for name in own if not marked[_AT[name][0]]}
        known = {name: chain for name, chain in chains.items() if chain is not None}
        self._at = np.array([_AT[name] for name in known])
        self._chains = Chains(list(known.values())) if known else None
        self._known = np.zeros(len(points), dtype=bool)
        for name in (*known, *([SILHOUETTE] if self._outline is not None else [])):
            self._known[_AT[name]] = True

    def match(self, points: np.ndarray, settled: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """The drawn point for each point of a face's lines; parameters and returns as `DrawnLines.match` has them.

        They are at the same shares of the length of both lines. What is missing at the end of a line has no weight.
        Where strokes are drawn over each other or come back, or an outline is open, it is the nearest point.
        """
        beside, marked = self._lines.beside(points, settled)
        drawn, squares = self._lines.nearest(beside, marked | self._known)
        if self._chains is not None:
            found, seen = self._chains.along(beside[self._at])
            drawn[self._at] = found
            squares[self._at] = np.where(seen, np.square(found - beside[self._at]).sum(axis=2), np.inf)
        if self._outline is not None:
            at = _AT[SILHOUETTE]
            drawn[at] = around(self._outline, beside[at])
            squares[at] = np.square(drawn[at] - beside[at]).sum(axis=1)
        return drawn, _weight(squares)


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


def shape_code(model: ShapeModel, points: np.ndarray, drawn: DrawnLines) -> np.ndarray:
    """A drawing's lines as `ShapeModel.describe` has them (p + q + r + 1,), found from a guess of where they are.

    Coefficients go no further than those of heads do, and details count by how much is true of them.

    Parameters
    ----------
    model : ShapeModel
    points : (n, 2) array
        The guess: the lines of an inferred face in the normalised frame.
    drawn : DrawnLines
        In that frame.
    """
    ordered = OrderedLines(drawn, points)
    found, weight = ordered.match(points)
    code = model.encode(found[None], weight[None])
    for _ in range(_ROUNDS - 1):
        found, weight = ordered.match(model.decode(code)[0], settled=True)
        code = model.encode(found[None], weight[None], near=code)
    details = model.detail_trust * model.details(found[None], weight[None])[0]
    return np.concatenate([soft_limit(code, *_CODE_LIMIT)[0], details, [1.0]], dtype=np.float32)


def _middle(points: np.ndarray) -> np.ndarray:
    return (points.min(axis=0) + points.max(axis=0)) / 2
