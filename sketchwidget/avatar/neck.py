"""The cut of the neck, which a head alone leaves open."""

from __future__ import annotations

import igl
import numpy as np

from ..face.model import FaceModel
from ..face.template import PARTS


def neck_cap(model: FaceModel) -> np.ndarray:
    """Triangles (t, 3) over the lowest border of the skin, which close it; seen from below they go round to the left.

    A fan about one vertex of the border, which is next to flat and convex.
    """
    skin = model.template.fine_parts == PARTS.index("skin")
    faces = model.faces[skin[model.faces].all(axis=1)].astype(np.int64)
    loops = [np.asarray(loop) for loop in igl.boundary_loop_all(faces)]
    loop = min(loops, key=lambda loop: model.mean[loop, 1].mean())
    fan = np.stack([np.full(len(loop) - 2, loop[0]), loop[1:-1], loop[2:]], axis=1)
    one, other, third = model.mean[fan].transpose(1, 0, 2)
    down = np.cross(other - one, third - one)[:, 1].sum() < 0
    return fan if down else fan[:, ::-1]
