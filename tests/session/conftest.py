from dataclasses import dataclass, field

import pytest

from sketchwidget.geometry.view import View
from sketchwidget.sketch import Sketch


@dataclass(frozen=True)
class DrawnFace:
    """Stands for a head: knows the drawing it was inferred from."""

    sketch: Sketch


@dataclass(frozen=True)
class FakeInference:
    face: DrawnFace
    names: tuple[str, ...]
    frame: View = field(default_factory=View)
    timings: dict = field(default_factory=lambda: {"network": 1.5})


class FakeRegressor:
    """Names the first segment "silhouette" and the others "wrinkle", at once and without a network."""

    def __init__(self):
        self.asked = 0

    def infer(self, sketch):
        self.asked += 1
        names = ("silhouette", *["wrinkle"] * (len(sketch) - 1)) if len(sketch) else ()
        return FakeInference(DrawnFace(sketch), names)


@pytest.fixture
def regressor():
    return FakeRegressor()
