"""Expressions of a new head: the template's, carried over by deformation transfer (section 3.3)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from ..face.model import FaceModel
from ..geometry.deformation_transfer import DeformationTransfer, deformation_gradients
from ..geometry.edges import edge_distance
from ..sketch import arc_length
from .eyes import SIDES, Eyeball, set_back
from .template import AvatarTemplate

_STILL_MM = 1e-3  # what moves less in every expression does not move
_CLEARANCE_MM = 0.25  # between lids and eyeball
_LID_MM = 14.0  # along the skin: how far closing lids pull it
_OVERLAP_MM = -0.1  # of closed lids
_UPPER_SHARE = 0.85  # of what is left of the opening, closed by the upper lid
_INSTANTS = (0.0, 0.25, 0.5, 0.75, 1.0)  # of a blink, at which lids must not enter the eye


class RigBuilder:
    """Makes rigs for heads of one model.

    Parameters
    ----------
    model : FaceModel
    template : AvatarTemplate
    """

    def __init__(self, model: FaceModel, template: AvatarTemplate) -> None:
        template.check(model)
        self._model, self._template = model, template
        self._soft, self._faces = model.template.soft
        self._moves = np.stack(list(template.actions.values())).astype(np.float64)
        self._held = np.abs(self._moves[:, self._soft]).max(axis=(0, 2)) < _STILL_MM
        neutral = template.neutral.astype(np.float64)
        self._gradients = np.stack(
            [
                deformation_gradients(neutral[self._soft], (neutral + move)[self._soft], self._faces)
                for move in self._moves
            ]
        )
        self._lids = {side: self._find_lids(side) for side in SIDES}

    def __call__(self, neutral: np.ndarray, eyes: list[Eyeball]) -> tuple[dict[str, np.ndarray], list[Eyeball]]:
        """The rig of a head.

        Parameters
        ----------
        neutral : (n, 3) array
            Coarse vertices at rest, millimetres.
        eyes : list of Eyeball
            As they touch the lids.

        Returns
        -------
        rig : dict of (V, 3) float32 arrays
            What each expression moves of the fine mesh, by ARKit's name; eyeballs are in none.
        eyes : list of Eyeball
            Set back by as much as closing lids need.
        """
        moves = self._moves.copy()
        rest = neutral[self._soft]
        moves[:, self._soft] = DeformationTransfer(rest, self._faces, self._held)(self._gradients) - rest
        refine = self._model.template.subdivision
        fine = np.stack([refine @ move for move in moves])
        fine[:, np.concatenate([eye.vertices for eye in eyes])] = 0.0
        rig = dict(zip(self._template.action_names, fine.astype(np.float32), strict=True))
        head = refine @ neutral
        return rig, [self._seated(head, rig, eye) for eye in eyes]

    def _seated(self, head: np.ndarray, rig: dict[str, np.ndarray], eye: Eyeball) -> Eyeball:
        """Make the lids of an eye meet when it blinks, and set the eye back so far that they pass over it."""
        lids = self._lids[eye.side]
        blink = rig[f"eyeBlink{eye.side.capitalize()}"]
        gap = lids.across @ (head + blink)  # of the upper lid over the lower; less than 0 where it is past it
        gap[:, 1] -= _OVERLAP_MM
        blink[lids.vertices] -= (lids.share @ gap).astype(np.float32)
        margin = lids.margin
        back = 0.0
        for instant in _INSTANTS:
            at = head[margin] + instant * blink[margin]
            aside = ((at[:, :2] - eye.centre[:2]) ** 2).sum(axis=1)
            over = aside < eye.radius**2
            front = eye.centre[2] + np.sqrt(eye.radius**2 - aside[over])
            back = max(back, float((front - at[over, 2]).max(initial=0.0)))
        return set_back(eye, back + _CLEARANCE_MM)

    def _find_lids(self, side: str) -> _Lids:
        curves, mean = self._model.curves, self._model.mean
        upper, lower = curves[f"{side}_eye_upper"][1:-1], curves[f"{side}_eye_lower"]
        rows = np.arange(len(upper))
        first, second, share = _between(_along(mean[lower]), _along(mean[curves[f"{side}_eye_upper"]])[1:-1])
        across = sparse.csr_matrix(
            (
                np.concatenate([np.ones(len(upper)), share - 1, -share]),
                (np.tile(rows, 3), np.concatenate([upper, lower[first], lower[second]])),
            ),
            shape=(len(upper), len(mean)),
        )
        away = [edge_distance(mean, self._model.faces, line, _LID_MM) for line in (upper, lower)]
        nearest = np.minimum(*away)
        vertices = np.flatnonzero(nearest < _LID_MM)
        fade = (1 - (nearest[vertices] / _LID_MM) ** 2) ** 2
        above = away[0][vertices] < away[1][vertices]
        amount = fade * np.where(above, _UPPER_SHARE, _UPPER_SHARE - 1)
        first, second, share = _between(mean[upper, 0], mean[vertices, 0])
        taken = sparse.csr_matrix(
            (
                np.concatenate([amount * (1 - share), amount * share]),
                (np.tile(np.arange(len(vertices)), 2), np.concatenate([first, second])),
            ),
            shape=(len(vertices), len(upper)),
        )
        return _Lids(vertices, taken, across, np.unique(np.concatenate([upper, lower])))


@dataclass(frozen=True, eq=False)
class _Lids:
    """Both lids of an eye.

    Parameters
    ----------
    vertices : (k,) int array
        Fine ones of the skin that closing lids pull along.
    share : (k, p) sparse matrix
        How much of the gap below each vertex of the upper lid's margin each of them takes.
    across : (p, V) sparse matrix
        Takes a head to these gaps: the vertex of the upper margin, less the point of the lower one as far along it.
    margin : (m,) int array
    """

    vertices: np.ndarray
    share: sparse.csr_matrix
    across: sparse.csr_matrix
    margin: np.ndarray


def _along(points: np.ndarray) -> np.ndarray:
    """How far along its line each point (n, 3) is, 0 to 1."""
    length = arc_length(points)
    return length / length[-1]


def _between(line: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where places (k,) are along a line (n,) that grows or falls: the numbers of two points, and the second's share.

    Beyond the ends it is the last point.
    """
    order = np.argsort(line, kind="stable")
    at = np.interp(places, line[order], np.arange(len(line)))
    first = np.minimum(at.astype(int), len(line) - 2)
    return order[first], order[first + 1], at - first


class Blend:
    """Adds expressions to a head at rest: ``S* = S_0 + B beta``, equation 13.

    Parameters
    ----------
    rest : (V, 3) array
    rig : dict of (V, 3) arrays
    """

    def __init__(self, rest: np.ndarray, rig: Mapping[str, np.ndarray]) -> None:
        self._rest = np.ascontiguousarray(rest, dtype=np.float32)
        self._number = {name: number for number, name in enumerate(rig)}
        basis = np.stack(list(rig.values())).astype(np.float32)
        self._moving = np.flatnonzero(np.abs(basis).max(axis=(0, 2)) > _STILL_MM)
        self._basis = np.ascontiguousarray(basis[:, self._moving].reshape(len(basis), -1))

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of the expressions."""
        return tuple(self._number)

    def beta(self, weights: Mapping[str, float]) -> np.ndarray:
        """Named weights as a vector; a ValueError tells of names that are none."""
        beta = np.zeros(len(self._number), dtype=np.float32)
        for name, weight in weights.items():
            if name not in self._number:
                raise ValueError(f"an expression is one of {', '.join(self._number)}; given {name!r}")
            if not np.isfinite(weight):
                raise ValueError(f"the weight of {name} is a finite number; given {weight!r}")
            beta[self._number[name]] = weight
        return beta

    def __call__(self, weights: Mapping[str, float]) -> np.ndarray:
        """The head (V, 3) with the named weights, usually 0 to 1."""
        vertices = self._rest.copy()
        vertices[self._moving] += (self.beta(weights) @ self._basis).reshape(-1, 3)
        return vertices
