"""Weights refined by the named lines of a drawing: Gauss-Newton from the network's answer on, which is the prior."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse

from ..face.drawing import outline_weights
from ..face.model import FaceModel
from ..geometry.view import CANVAS_MM
from ..sketch import SILHOUETTE
from .framing import Frame
from .matching import PLACES
from .shape_code import COUNTS, LINES, OUTLINE_STEP, POINTS, sample_indices

Match = Callable[[np.ndarray, bool], tuple[np.ndarray, np.ndarray]]

# Canvas units by which people misplace a feature as a whole, and by which its points miss the line that they mean.
_MISPLACED, _MISDRAWN = 0.015, 0.01
# Which points belong to each feature, (features, points): a feature is what may be drawn by one stroke.
_MEMBERS = np.stack([np.isin(np.arange(POINTS), at) for at in PLACES.values()]).astype(np.float64)
_ERRORS = (0.45, 0.6)  # standard deviations by which the network misses identity and expression weights
_PLACE_ERROR = 0.02  # of scale, and canvas units of place, by which the frames of drawing and head differ


class LineRefiner:
    """Moves the lines of a head of one model towards drawn ones.

    Least squares of what is left between drawn and projected points, each counting by how near they are, and of how far
    weights, scale and place leave the network's answer. Points are matched anew in each step.

    Parameters
    ----------
    model : FaceModel
    standard : dict of arrays
        Mean and standard deviation of the weights, as the regressor has them.
    errors : (float, float)
        Standard deviations by which identity and expression weights miss where they start from. With 1 and the mean
        face to start from, this is the fitting of a morphable model under its prior.
    steps : int
        Of Gauss-Newton.
    steady : bool
        Whether what is not drawn keeps its shape; otherwise the prior alone says where it goes.
    """

    def __init__(
        self,
        model: FaceModel,
        standard: dict[str, np.ndarray],
        errors: tuple[float, float] = _ERRORS,
        steps: int = 2,
        steady: bool = True,
    ) -> None:
        self._steps, self._steady = steps, steady
        self._identity_std, self._expression_std = standard["identity_std"], standard["expression_std"]
        basis = model.bilinear.basis.reshape(-1, 3, model.bilinear.basis.shape[1])
        pick = sparse.vstack([sparse.csr_matrix(_sampling(model, name)) @ _handle(model, name) for name in LINES])
        # On the canvas y goes down.
        on_canvas = np.stack([pick @ basis[:, 0], -(pick @ basis[:, 1])], axis=1) / CANVAS_MM
        # Of the model only the lines: (n, 2, p, q), and transposed for the derivative by the expression.
        self._core = np.tensordot(on_canvas, model.bilinear.core, axes=1).astype(np.float32)
        self._transposed = np.ascontiguousarray(self._core.swapaxes(-1, -2))
        self._mean = (pick @ model.bilinear.mean.reshape(-1, 3))[:, :2] * [1, -1] / CANVAS_MM + 0.5
        sizes = (*self._core.shape[2:], 3)
        self._prior = np.repeat((*errors, _PLACE_ERROR), sizes) ** -2.0

    def lines(self, identity: np.ndarray, expression: np.ndarray) -> np.ndarray:
        """Points (n, 2) of a head's lines in the canonical front view."""
        return self._mean + self._core @ expression @ identity

    def framed(self, identity: np.ndarray, expression: np.ndarray) -> np.ndarray:
        """The same as they stand in a normalised drawing."""
        lines = self.lines(identity, expression)
        scale, offset = _outline_frame(lines)
        return scale * (lines - 0.5) + 0.5 + offset

    def __call__(self, identity: np.ndarray, expression: np.ndarray, match: Match) -> tuple[np.ndarray, np.ndarray]:
        """Identity (p,) and expression (q,) weights whose lines are nearer to the drawn ones.

        Parameters
        ----------
        identity, expression : (p,) and (q,) arrays
            The network's answer.
        match : callable
            Gives the drawn points and their weights for the points of the lines, as `DrawnLines.match` does, in the
            normalised drawing.
        """
        p, q = self._core.shape[2:]
        change = np.zeros(p + q + 3)
        start = self.lines(identity, expression)
        frame = _outline_frame(start)
        for step in range(self._steps):
            u, v = self._moved(identity, expression, change)
            scale, offset = frame[0] * np.exp(change[-3]), frame[1] + change[-2:]
            by_identity, by_expression = self._core @ v, self._transposed @ u
            free = self._mean + by_identity @ u
            points = scale * (free - 0.5) + 0.5 + offset
            target, weight = match(points, step > 0)
            if not weight.any():
                return identity, expression
            # What is not drawn keeps its shape.
            unseen = _unseen(weight) if self._steady else np.zeros(len(points), dtype=bool)
            target, weight = np.where(unseen[:, None], points + scale * (start - free), target), weight + unseen
            seen = (~unseen)[:, None, None]
            # Derivatives by weights, scale and place, and the residual behind them: (n, 2, p + q + 4).
            rows = np.concatenate(
                [
                    by_identity * (scale * self._identity_std),
                    by_expression * (scale * self._expression_std),
                    seen * scale * (free - 0.5)[..., None],
                    seen * np.eye(2),
                    (target - points)[..., None],
                ],
                axis=2,
            )
            normal = _normal_matrix(rows, weight)
            change += np.linalg.solve(normal[:-1, :-1] + np.diag(self._prior), normal[:-1, -1] - self._prior * change)
        return self._moved(identity, expression, change)

    def _moved(self, identity: np.ndarray, expression: np.ndarray, change: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        p, q = self._core.shape[2:]
        u, v = identity + self._identity_std * change[:p], expression + self._expression_std * change[p : p + q]
        return u.astype(np.float32), v.astype(np.float32)


def _unseen(weight: np.ndarray) -> np.ndarray:
    """Points (n,) bool of the features of which nothing is drawn."""
    return ~(_MEMBERS.T @ (_MEMBERS @ weight > 0)).astype(bool)


def _normal_matrix(rows: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Products (k, k) of the columns of rows (n, 2, k) of weighted points, by the inverse covariance of their errors.

    Errors are alike within a feature, and besides each point has its own: the inverse is that of the own ones, less a
    matrix of rank 1 for each feature (Sherman and Morrison).
    """
    alike = (_MISPLACED / _MISDRAWN) ** 2
    own = (np.sqrt(weight)[:, None, None] * rows).reshape(-1, rows.shape[2])
    share = np.sqrt(alike / (1 + alike * (_MEMBERS @ weight)))
    common = (share[:, None] * _MEMBERS * weight @ rows.reshape(len(rows), -1)).reshape(-1, rows.shape[2])
    return (own.T @ own - common.T @ common) / _MISDRAWN**2


def _handle(model: FaceModel, name: str) -> sparse.csr_matrix:
    """The handle of a line from coarse vertices."""
    return model.template.subdivision[model.curves[name]]


def _sampling(model: FaceModel, name: str) -> np.ndarray:
    """The points of a line that the shape model knows as weights (n, k) of its handle's: exact on the mean face."""
    handle = model.mean[model.curves[name], :2]
    if name == SILHOUETTE:
        return outline_weights(handle)[: OUTLINE_STEP * COUNTS[name] : OUTLINE_STEP]
    return np.eye(len(handle))[sample_indices(len(handle))]


def _outline_frame(points: np.ndarray) -> tuple[float, np.ndarray]:
    """Scale about the canvas's middle, and offset, that normalise lines by their outline."""
    frame = Frame.of_outline(points[: COUNTS[SILHOUETTE]])
    return frame.scale, np.asarray(frame.offset) + 0.5 * frame.scale - 0.5
