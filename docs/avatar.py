"""Make docs/avatar.png: a portrait, its avatar at rest and in expressions.

python docs/avatar.py, after `sketchwidget models`
"""

from pathlib import Path

import numpy as np
from PIL import Image
from skimage import data

import sketchwidget as sw
from sketchwidget.geometry.view import CANVAS_MM, View

SIZE = 230
SHOWN = (
    ("front", {}),
    ("three-quarter", {}),
    (
        "front",
        {"mouthSmileLeft": 0.8, "mouthSmileRight": 0.8, "jawOpen": 0.25, "cheekSquintLeft": 1, "cheekSquintRight": 1},
    ),
    ("front", {"jawOpen": 0.6, "browInnerUp": 0.8, "eyeWideLeft": 0.7, "eyeWideRight": 0.7}),
    ("three-quarter", {"eyeBlinkLeft": 1, "mouthSmileLeft": 0.8, "mouthPucker": 0.2}),
)

avatar = sw.avatar.build(data.astronaut())
pictures = [np.array(Image.fromarray(avatar.stages["portrait"]).resize((SIZE, SIZE)))]
for name, weights in SHOWN:
    view = View(View.preset(name).rotation, 1.05 / CANVAS_MM, np.array([0.5, 0.46]))
    pictures.append(avatar.picture(weights, view, SIZE))
Image.fromarray(np.hstack(pictures)).save(Path(__file__).with_suffix(".png"), optimize=True)
