"""Which pixels of a picture belong to a person."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import cv2
import numpy as np

from .mediapipe import read_network

_SIDE = 256
_OVAL_MARGIN = 0.12  # about the face, of its breadth


class PersonMask:
    """The cached segmentation model.

    Raises
    ------
    ValueError
        On first use, if the model is missing; the message tells how to get it.
    """

    def __call__(self, image: np.ndarray) -> np.ndarray:
        """How sure each pixel of a picture (H, W, 3) uint8 is part of a person, (H, W) float32 from 0 to 1."""
        small = cv2.resize(image, (_SIDE, _SIDE), interpolation=cv2.INTER_AREA).astype(np.float32) / 255
        self._network.setInput(cv2.dnn.blobFromImage(small))
        confidence = self._network.forward().reshape(_SIDE, _SIDE)
        confidence = cv2.resize(confidence, image.shape[1::-1], interpolation=cv2.INTER_LINEAR)
        return np.clip(confidence, 0.0, 1.0).astype(np.float32)

    @cached_property
    def _network(self) -> Any:
        return read_network("selfie_segmentation")


def face_oval(points: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """The face alone by its landmarks (68, 2): jaw, and a brow as high above the eyes as they are above the nose.

    Parameters
    ----------
    points : (68, 2) array
        Pixels.
    shape : (int, int)
        Height and width of the picture.

    Returns
    -------
    (H, W) bool array
    """
    up = points[27] - points[33]
    brow = points[17:27] + 0.9 * up
    outline = cv2.convexHull(np.concatenate([points[:27], brow]).astype(np.float32))[:, 0]
    middle = outline.mean(axis=0)
    outline = middle + (1 + _OVAL_MARGIN) * (outline - middle)
    mask = np.zeros(shape, dtype=np.uint8)
    cv2.fillPoly(mask, [np.rint(outline).astype(np.int32)], 1)
    return mask.astype(bool)
