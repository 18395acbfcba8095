"""What speaks against a face that a detector found."""

from __future__ import annotations

import cv2
import numpy as np

from .landmarks import FaceLandmarks
from .mask import face_oval

_UNSURE = 0.02  # of the score: genuine caricatures have 0.03, a cat has 0.01
_LIDS = 0.15  # of the breadth of an eye: what is looked at about its opening
_DARK = 0.6  # of the skin's lightness: bare eyes reach 0.97 at least, dark glasses in a portrait 0.1 to 0.5

HIDDEN_EYES = "The eyes seem hidden, by sunglasses perhaps: give a picture without, or drag the eyes' landmarks."


def is_face(marks: FaceLandmarks) -> bool:
    """Whether what was found may be a face."""
    return marks.score >= _UNSURE


def eyes_hidden(image: np.ndarray, marks: FaceLandmarks) -> bool:
    """Whether something dark lies over both eyes: nothing in and about them is nearly as light as the skin.

    Parameters
    ----------
    image : (H, W, 3) uint8 array
    marks : FaceLandmarks
        In its pixels; without eyelids nothing is known, and the answer is no.
    """
    if len(marks.eyelids) < 2:
        return False
    lightness = cv2.cvtColor(image, cv2.COLOR_RGB2LAB)[..., 0].astype(np.float32)
    oval = face_oval(marks.points, image.shape[:2])
    skin = float(np.median(lightness[oval])) if oval.any() else 0.0
    for contour in marks.eyelids.values():
        eye = np.zeros(image.shape[:2], dtype=np.uint8)
        cv2.fillPoly(eye, [np.rint(contour).astype(np.int32)], 1)
        side = 2 * int(_LIDS * np.ptp(contour[:, 0])) + 1
        eye = cv2.dilate(eye, np.ones((side, side), dtype=np.uint8)) > 0
        if not eye.any() or np.percentile(lightness[eye], 95) >= _DARK * skin:
            return False
    return True
