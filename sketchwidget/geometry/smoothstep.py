"""A smooth step, by Hermite's cubic."""

from __future__ import annotations

import numpy as np


def smoothstep(values: np.ndarray, low: float = 0.0, high: float = 1.0) -> np.ndarray:
    """0 up to `low`, 1 from `high` on, which is above it, and between them a rise whose slope is 0 at both ends."""
    share = np.clip((values - low) / (high - low), 0.0, 1.0)
    return share**2 * (3 - 2 * share)
