"""Make docs/avatar.png: a portrait, its avatar at rest and in expressions.

python docs/avatar.py, after `sketchwidget models`
"""

from dataclasses import replace
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
    # Closer than a picture of the whole head: these are small, and the face is what differs.
    view = replace(View.preset(name), scale=1.05 / CANVAS_MM, centre=np.array([0.5, 0.46]))
    pictures.append(avatar.picture(weights, view, SIZE))
Image.fromarray(np.hstack(pictures)).save(Path(__file__).with_suffix(".png"), optimize=True)
