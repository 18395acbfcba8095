"""Triangles that an edit turned over."""

import numpy as np


def turned_over(model, before, after):
    """How many triangles of the skin that faced the front before (V, 3) face the back after (V, 3).

    What overhangs before is no fold, and what is seen almost edge-on does not tell.
    """
    skin = model.faces[(model.template.fine_parts == 0)[model.faces].all(axis=1)]
    normals = [np.cross(*np.moveaxis(np.diff(vertices[skin], axis=1), 1, 0)) for vertices in (before, after)]
    faced = normals[0][:, 2] > 0.5 * np.linalg.norm(normals[0], axis=1)
    return int((faced & (normals[1][:, 2] < 0)).sum())
