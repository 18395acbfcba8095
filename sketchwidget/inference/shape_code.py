"""The shape of a drawing's lines in a few coefficients: a 2D bilinear model (paper 4.3, Shape-Level Input)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..sketch import FEATURES, SILHOUETTE

LINES = (SILHOUETTE, *FEATURES)

OUTLINE_STEP = 3  # every third of the 180 points of a drawn outline
_OUTLINE_POINTS = 60
_LINE_POINTS = 12
_NOISE = 0.005  # canvas units by which drawn lines stray: how much the points count against the prior
_ROUNDS = 3
_FARTHEST = 8.0  # standard deviations that a detail goes to

COUNTS = {name: _OUTLINE_POINTS if name == SILHOUETTE else _LINE_POINTS for name in LINES}
POINTS = sum(COUNTS.values())
DETAILS = 360  # numbers that tell what the points themselves are like


def sample(lines: Mapping[str, np.ndarray]) -> np.ndarray:
    """The points of whole lines that the model knows, one line after the other.

    Parameters
    ----------
    lines : mapping of (k, d) arrays
        By name; the silhouette as `sketchwidget.face.drawing.outline` draws it, the others along their handles.

    Returns
    -------
    (n, d) array
    """
    points = [lines[SILHOUETTE][: OUTLINE_STEP * _OUTLINE_POINTS : OUTLINE_STEP]]
    points += [lines[name][sample_indices(len(lines[name]))] for name in FEATURES]
    return np.concatenate(points)


def sample_indices(length: int) -> np.ndarray:
    """Which points of a feature line of `length` points the model knows."""
    return np.rint(np.linspace(0, length - 1, _LINE_POINTS)).astype(int)


def split_lines(points: np.ndarray) -> dict[str, np.ndarray]:
    """Points (n, ...) of the model by line."""
    pieces = np.split(points, np.cumsum(list(COUNTS.values()))[:-1])
    return dict(zip(COUNTS, pieces, strict=True))


@dataclass(frozen=True)
class ShapeModel:
    """A bilinear model of the points of silhouette and feature lines in normalised drawings.

    Parameters
    ----------
    mean : (d,) array
        d = 2 n flattened points.
    core : (d, p, q) array
        ``mean + core x_2 u x_3 v`` are the points of a drawing.
    identity_mean, identity_std : (p,) arrays
        Of u over the people that the model is made of.
    expression_mean, expression_std : (q,) arrays
        Of v over their expressions.
    detail_mean : (3 n,) array
        Of `weighted` points over drawings.
    detail_axes : (3 n, r) array
        Directions in which these differ, each over its standard deviation.
    detail_trust : (r,) array
        Of each detail, how much is true of it where points were found, from 0 to 1.
    """

    mean: np.ndarray
    core: np.ndarray
    identity_mean: np.ndarray
    identity_std: np.ndarray
    expression_mean: np.ndarray
    expression_std: np.ndarray
    detail_mean: np.ndarray
    detail_axes: np.ndarray
    detail_trust: np.ndarray

    @property
    def size(self) -> int:
        """Number of coefficients of a drawing."""
        return self.core.shape[1] + self.core.shape[2]

    def encode(self, points: np.ndarray, seen: np.ndarray, near: np.ndarray | None = None) -> np.ndarray:
        """Coefficients of drawings, of which some points may be missing.

        The most likely ones under a normal prior, by alternating least squares from the mean on: what is not seen is
        filled in by what goes with the rest, and a drawing of which nothing is seen has the coefficients 0.

        Parameters
        ----------
        points : (b, n, 2) array
            In the order of `sample`, in normalised drawings; what is not seen may be anything finite.
        seen : (b, n) array
            How much each point counts, from 0 to 1.
        near : (b, p + q) array, optional
            Coefficients to begin with in place of the mean, near those of the points: then one round is enough.

        Returns
        -------
        (b, p + q) float32 array
            Standardised.
        """
        count = len(points)
        target = points.reshape(count, -1).astype(np.float32) - self.mean
        weight = np.repeat(seen.astype(np.float32), 2, axis=1) / _NOISE**2
        p, q = self.core.shape[1:]
        begin = np.zeros((count, p + q), np.float32) if near is None else near
        identity, expression = begin[:, :p], begin[:, p:]
        for _ in range(_ROUNDS if near is None else 1):
            by_identity = self._by_identity(self.expression_mean + self.expression_std * expression)
            rest = target - by_identity @ self.identity_mean
            identity = _most_likely(by_identity * self.identity_std, rest, weight)
            by_expression = self._by_expression(self.identity_mean + self.identity_std * identity)
            rest = target - by_expression @ self.expression_mean
            expression = _most_likely(by_expression * self.expression_std, rest, weight)
        return np.concatenate([identity, expression], axis=1)

    def describe(self, points: np.ndarray, seen: np.ndarray) -> np.ndarray:
        """Coefficients of drawings, their details, and 0: (b, p + q + r + 1) float32.

        The last number is 1 where points had to be found, see `sketchwidget.inference.matching.shape_code`: a network
        believes those less than points of which it is known which is which, as these are.

        Parameters as `encode` has them.
        """
        codes = self.encode(points, seen)
        return np.concatenate([codes, self.details(points, seen), np.zeros_like(codes[:, :1])], axis=1)

    def details(self, points: np.ndarray, seen: np.ndarray) -> np.ndarray:
        """What the points themselves tell, and which of them are seen: (b, r), each number of unit spread.

        Heads differ in the breadth of a jaw by a hundred times what they differ in by the bow of a lid; along the
        principal directions of drawings, each over its standard deviation, a network hears of either as loudly.

        Parameters as `encode` has them.
        """
        details = (weighted(self.mean, points, seen) - self.detail_mean) @ self.detail_axes
        return np.clip(details, -_FARTHEST, _FARTHEST).astype(np.float32)

    def decode(self, codes: np.ndarray) -> np.ndarray:
        """Points (b, n, 2) of coefficients (b, p + q)."""
        p = self.core.shape[1]
        u = self.identity_mean + self.identity_std * codes[:, :p]
        v = self.expression_mean + self.expression_std * codes[:, p:]
        return (self.mean + (self._by_identity(v) @ u[..., None])[..., 0]).reshape(len(codes), -1, 2)

    def _by_identity(self, expression: np.ndarray) -> np.ndarray:
        """Points as linear functions (b, d, p) of the identity, for expressions (b, q)."""
        return (expression @ self._flat[0]).reshape(len(expression), *self.core.shape[:2])

    def _by_expression(self, identity: np.ndarray) -> np.ndarray:
        """Points as linear functions (b, d, q) of the expression, for identities (b, p)."""
        return (identity @ self._flat[1]).reshape(len(identity), self.core.shape[0], -1)

    @cached_property
    def _flat(self) -> tuple[np.ndarray, np.ndarray]:
        """The core as matrices, (q, d p) and (p, d q)."""
        p, q = self.core.shape[1:]
        return (
            np.ascontiguousarray(self.core.transpose(2, 0, 1).reshape(q, -1)),
            np.ascontiguousarray(self.core.transpose(1, 0, 2).reshape(p, -1)),
        )


def weighted(mean: np.ndarray, points: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """How far points (b, n, 2) are from those of a mean (2 n,), and how much they count (b, n): (b, 3 n) float32.

    What counts less is less off, in units of the drawing noise; what is not seen may be anything finite and is 0.
    """
    off = np.where(seen[..., None] > 0, seen[..., None] * (points - mean.reshape(-1, 2)), 0.0) / _NOISE
    return np.concatenate([off.reshape(len(points), -1), seen], axis=1, dtype=np.float32)


def _most_likely(design: np.ndarray, target: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Weighted ridge regression of each row: designs (b, d, k), targets and weights (b, d) to (b, k)."""
    weighted = (design * weight[..., None]).transpose(0, 2, 1)
    normal = weighted @ design + np.eye(design.shape[2], dtype=design.dtype)
    return np.linalg.solve(normal, weighted @ target[..., None])[..., 0]
