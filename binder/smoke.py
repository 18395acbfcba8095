"""Tries what a visitor of Binder does first: import, draw, look at a Studio; and that a kernel has room for it."""

from __future__ import annotations

import resource
import sys
import time
from pathlib import Path

MEMORY = 900  # MB that a kernel with a Studio may take; Binder gives 1 to 2 GB

began = time.perf_counter()
import sketchwidget as sw  # noqa: E402

imported = time.perf_counter() - began
assert "torch" not in sys.modules, "the import is no longer light"

assert (Path(sw.__file__).parents[1] / "benchmarks").is_dir(), "the package is not in place: notebooks read beside it"

import numpy as np  # noqa: E402
import torch  # noqa: E402

assert torch.version.cuda is None, f"torch {torch.__version__} is no CPU build"

turn = np.linspace(0, 2 * np.pi, 60)
studio = sw.Studio()
before = studio.session.face.vertices
studio.session.draw(np.stack([0.5 + 0.22 * np.sin(turn), 0.5 - 0.39 * np.cos(turn)], axis=1))
after = studio.session.face.vertices
assert after.shape == before.shape and np.isfinite(after).all() and not np.array_equal(after, before)
assert set(studio.session.sketch.lines) == {"silhouette"}
studio.session.mode = "followup"
assert "left_brow" in studio.session.sketch.lines
replayed = sw.Session.loads(studio.session.dumps())
assert np.array_equal(replayed.face.vertices, studio.session.face.vertices)

memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
assert memory < MEMORY, f"a Studio takes {memory:.0f} MB"
print(f"import {1000 * imported:.0f} ms, {memory:.0f} MB with a Studio that has a drawing")
