"""Weights kept within what heads can bear."""

from __future__ import annotations

import numpy as np


def soft_limit(values: np.ndarray, free: float, most: float) -> np.ndarray:
    """Values as they are up to `free` on both sides, then bent smoothly so that none is beyond `most`."""
    excess = np.maximum(np.abs(values) - free, 0)
    bent = (most - free) * np.tanh(excess / (most - free))
    return np.sign(values) * (np.minimum(np.abs(values), free) + bent)
