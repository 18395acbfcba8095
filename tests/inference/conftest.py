import numpy as np
import pytest

from sketchwidget import FaceRegressor


@pytest.fixture(scope="session")
def regressor():
    return FaceRegressor.load()


@pytest.fixture
def drawing():
    """Strokes of a plain freehand face: an oval, eyes, a nose and a mouth."""
    angle = np.linspace(0, 2 * np.pi, 60)
    oval = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return [
        [0.5, 0.5] + oval * [0.27, 0.38],
        [0.39, 0.46] + oval * [0.05, 0.018],
        [0.61, 0.46] + oval * [0.05, 0.018],
        np.array([[0.46, 0.6], [0.48, 0.62], [0.5, 0.625], [0.52, 0.62], [0.54, 0.6]]),
        np.array([[0.42, 0.72], [0.46, 0.725], [0.5, 0.727], [0.54, 0.725], [0.58, 0.72]]),
    ]
