"""The picture of the README that shows a deformation space: python docs/caricature_sheet.py"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

import sketchwidget as sw
from sketchwidget.caricature.fitting import deformable_head
from sketchwidget.geometry.deformation_space import DeformationSpace

BY_MOUTH, BY_PERSON = (-1, 0, 1, 1.75, 2.5), (2.5, 1, 0, -1)
SIZE = 150


def main() -> None:
    """Write `caricature.png` beside this file: two examples, weights from -1 to 2.5 (Alive Caricature, Figure 2)."""
    model = sw.FaceModel.load()
    head = deformable_head(model)
    examples = [model.face(expression="mouth_open"), model.face(model.bilinear.identities[28])]
    space = DeformationSpace(head.representation, [head.coarse(face.vertices)[head.skin] for face in examples])

    def picture(by_mouth: float, by_person: float) -> np.ndarray:
        weights = np.tile([by_mouth, by_person], (2, 1))
        return sw.Face(model, head.vertices(space.vertices(weights))).picture(size=SIZE)

    rows = [np.hstack([picture(by_mouth, by_person) for by_mouth in BY_MOUTH]) for by_person in BY_PERSON]
    Image.fromarray(np.vstack(rows)).save(Path(__file__).parent / "caricature.png")


if __name__ == "__main__":
    main()
