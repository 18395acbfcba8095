"""How fast the kernel's half is on this machine: import, inference, memory.

python -m benchmarks.kernel [--repeat 100]
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

import sketchwidget as sw
from sketchwidget.geometry.region_deformation import RegionDeformation
from sketchwidget.gesture.shapes import example
from sketchwidget.gesture.writers import Writer
from sketchwidget.threads import one_thread

_DRAWING = Path(__file__).parents[1] / "docs" / "freehand" / "04_calm.json"  # a whole face, ears too

_MEMORY = """
import resource, sketchwidget as sw, numpy as np
studio = sw.Studio()
turn = np.linspace(0, 2 * np.pi, 60)
studio.session.draw(np.stack([0.5 + 0.27 * np.sin(turn), 0.5 - 0.39 * np.cos(turn)], axis=1))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


def measure(repeat: int = 100) -> dict[str, Any]:
    """Milliseconds (medians) of each step, and the memory in MB of a Python that holds a Studio after a stroke."""
    regressor = sw.FaceRegressor.load()
    sketch = sw.Sketch.load(_DRAWING)
    image = sketch.image()
    identity, expression = regressor.weights(image[None])
    return {
        "import": _fresh("import sketchwidget"),
        "network": _median(lambda: regressor.weights(image[None]), repeat),
        "mesh": _median(lambda: regressor.model.vertices(identity[0], expression[0]), repeat),
        "inference": _median(lambda: regressor.infer(sketch), repeat),
        "inference, one thread": _on_one_thread(lambda: regressor.infer(sketch), repeat),
        "session": _stroke(regressor, repeat),
        **_refinement(),
        **_deformation(regressor, repeat),
        "followup": _redrawing(regressor, repeat),
        **_caricature(regressor.model),
        "memory": int(subprocess.check_output([sys.executable, "-c", _MEMORY])) / 1024,
    }


def _median(step: Any, repeat: int) -> float:
    times = []
    for _ in range(repeat + 5):
        began = time.perf_counter()
        step()
        times.append(time.perf_counter() - began)
    return 1000 * statistics.median(times[5:])


def _on_one_thread(step: Any, repeat: int) -> float:
    """Median milliseconds of a step that is done as a session does all."""
    with one_thread():
        return _median(step, repeat)


def _stroke(regressor: sw.FaceRegressor, repeat: int) -> float:
    """A whole `Session.draw` of one more eyebrow on a drawn face, another one each time: heads are remembered."""
    session = sw.Session(regressor)
    turn = np.linspace(0, 2 * np.pi, 60)
    session.draw(np.stack([0.5 + 0.27 * np.sin(turn), 0.5 - 0.39 * np.cos(turn)], axis=1))
    brow = np.array([[0.33, 0.41], [0.39, 0.385], [0.46, 0.40]])

    times = []
    for number in range(repeat // 2 + 5):
        began = time.perf_counter()
        session.draw(brow + 1e-4 * number)
        times.append(time.perf_counter() - began)
        session.undo()
    return 1000 * statistics.median(times[5:])


def _refinement() -> dict[str, float]:
    """A gesture told from the others; a region of the head deformed by handles, once it is factored."""
    stroke = Writer.random(3_000).draw("up roll 3", np.random.default_rng(0))
    classifier = sw.GestureClassifier.load()
    session = sw.Session(inference=False)
    face, chin = session.face, sw.View().project(session.face.landmarks[8])
    session.gesture(example("region", chin - np.array([0, 0.1]), 0.5))  # mouth and chin
    session.brush(session.under_brush([chin - np.array([0, 0.03])], 0.03))
    region = np.zeros(len(face.vertices), dtype=bool)
    region[session.region] = True
    began = time.perf_counter()
    deformation = RegionDeformation(face.vertices, face.faces, region, session.handles)
    factor = 1000 * (time.perf_counter() - began)
    moves = np.tile([0.0, -5.0, 5.0], (len(session.handles), 1))

    def gesture() -> None:
        session.gesture(stroke)
        session.undo()

    return {
        "classification": _median(lambda: classifier.classify(stroke), 100),
        "factor": factor,
        "region": _median(lambda: deformation.displacement(moves), 100),
        "gesture": _median(gesture, 30),
    }


def _deformation(regressor: sw.FaceRegressor, repeat: int) -> dict[str, float]:
    """All lines of a head dragged elsewhere; and a mouth drawn twice as wide, which would fold the skin about it."""
    model = regressor.model
    lines = {name: model.mean[path, :2] for name, path in model.curves.items() if not name.startswith("lip")}
    larger = {name: 1.1 * line for name, line in lines.items()}
    wide = lines | {name: line * [2.0, 1.0] for name, line in lines.items() if "mouth" in name}
    return {
        "deformation": _on_one_thread(lambda: model.handles(model.mean, larger), repeat),
        "unfolding": _on_one_thread(lambda: model.handles(model.mean, wide), repeat),
    }


def _redrawing(regressor: sw.FaceRegressor, repeat: int) -> float:
    """A whole `Session.draw` of a piece of a brow in follow-up sketching: inference and deformation."""
    session = sw.Session(regressor)
    session.start_from_template()
    piece = session.sketch.lines["left_brow"][0]
    session.erase(piece[len(piece) // 2], radius=0.005)
    times = []
    for _ in range(repeat // 2 + 5):
        began = time.perf_counter()
        session.draw(piece - np.float32([0, 0.02]))
        times.append(time.perf_counter() - began)
        session.undo()
    return 1000 * statistics.median(times[5:])


def _caricature(model: sw.FaceModel) -> dict[str, float]:
    """Fits to the landmarks of an exaggerated face: a whole one, and one iteration as while a landmark is dragged."""
    subject = sw.caricature.exaggerate(model.face(model.bilinear.identities[28], "grin_open"), 2.0)
    landmarks = subject.landmarks[:, :2] * [1.5, -1.5] + 200.0
    first = sw.caricature.fit(landmarks, model=model)
    return {
        "caricature": _median(lambda: sw.caricature.fit(landmarks, model=model), 5),
        "caricature step": _median(lambda: sw.caricature.fit(landmarks, model=model, start=first, iterations=1), 5),
    }


def _fresh(code: str, repeat: int = 7) -> float:
    """Median milliseconds of a statement in a fresh Python."""
    timed = f"import time; t = time.perf_counter(); {code}; print(time.perf_counter() - t)"
    times = [float(subprocess.check_output([sys.executable, "-c", timed])) for _ in range(repeat)]
    return 1000 * statistics.median(times)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=100)
    print(json.dumps(measure(parser.parse_args().repeat), indent=1))
