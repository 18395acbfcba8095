"""Non-linear least squares with many residuals and few unknowns."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

_FIRST_DAMPING, _LAST_DAMPING = 1e-4, 1e8
_UP, _DOWN = 10.0, 0.1


def levenberg_marquardt(
    cost: Callable[[np.ndarray], float],
    normal_equations: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    start: np.ndarray,
    iterations: int = 30,
    tolerance: float = 1e-7,
) -> np.ndarray:
    """Unknowns that make a sum of squares least, by its normal equations, damped by their diagonal.

    With hundreds of residuals for each unknown these are cheap, where the QR decomposition of
    `scipy.optimize.least_squares` takes most of the time; and unknowns that follow others can be eliminated from them.

    Parameters
    ----------
    cost : callable
        Sum of squares, of unknowns (k,).
    normal_equations : callable
        Of unknowns (k,): ``J^T J`` (k, k) and ``J^T r`` (k,), of the residuals r and their Jacobian J.
    start : (k,) array
    iterations : int
        At most.
    tolerance : float
        A step that lowers the cost by a smaller share is the last.

    Returns
    -------
    (k,) array

    References
    ----------
    More, "The Levenberg-Marquardt algorithm: implementation and theory", 1978.
    """
    unknowns, damping = np.array(start, dtype=np.float64), _FIRST_DAMPING
    now = cost(unknowns)
    for _ in range(iterations):
        normal, gradient = normal_equations(unknowns)
        diagonal = np.maximum(np.diag(normal), 1e-12 * np.trace(normal))
        while damping < _LAST_DAMPING:
            moved = unknowns - np.linalg.solve(normal + np.diag(damping * diagonal), gradient)
            after = cost(moved)
            if after < now:
                break
            damping *= _UP
        else:
            return unknowns
        unknowns, damping = moved, damping * _DOWN
        before, now = now, after
        if before - now <= tolerance * before:
            break
    return unknowns
