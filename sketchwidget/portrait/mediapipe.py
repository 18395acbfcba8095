"""MediaPipe's face networks, run by OpenCV."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import cv2
import numpy as np

from . import models
from .ibug import EYE_CORNERS, ibug_68
from .landmarks import FaceLandmarks

# Face detection: a picture of 128 pixels, two anchors a cell at a stride of 8, six at 16.
_DETECTOR_SIDE, _ANCHORS = 128, ((8, 2), (16, 6))
_SURE, _OVERLAP = 0.5, 0.3
_MESH_SIDE, _MESH_MARGIN = 192, 1.5  # of the box, as the network was trained
_EYE_SIDE, _EYE_MARGIN = 64, 2.3  # of the distance between the corners of the eye
_LOWER, _UPPER = slice(0, 9), slice(9, 16)  # of the lids' contour: inner to outer corner; without the corners


class MediaPipeDetector:
    """Faces, landmarks, eyelids and irises by the cached models.

    Raises
    ------
    ValueError
        On first use, if a model is missing; the message tells how to get it.
    """

    def faces(self, image: np.ndarray) -> np.ndarray:
        """Boxes (k, 4) of the faces in a picture (H, W, 3) uint8: left, top, width, height in pixels, largest first.

        Small faces in large pictures are looked for in nine overlapping parts, if there is none in the whole.
        """
        height, width = image.shape[:2]
        found = self._detect(image, 0, 0)
        if not len(found):
            half = [(top, left) for top in range(3) for left in range(3)]
            parts = [(top * height // 4, left * width // 4) for top, left in half]
            found = [self._detect(image[y : y + height // 2, x : x + width // 2], x, y) for y, x in parts]
            found = np.concatenate(found)
        boxes, scores = found[:, :4], found[:, 4]
        kept = np.ravel(cv2.dnn.NMSBoxes(boxes.tolist(), scores.tolist(), _SURE, _OVERLAP)).astype(int)
        return boxes[kept[np.argsort(-boxes[kept, 2] * boxes[kept, 3])]]

    def landmarks(self, image: np.ndarray, box: np.ndarray) -> FaceLandmarks:
        """The marks of the face in a box (4,): looked for twice, the second time upright and centred."""
        left, top, width, height = box
        centre, extent, angle = np.array([left + width / 2, top + height / 2]), max(width, height), 0.0
        for _ in range(2):
            mesh, score = self._mesh(image, centre, _MESH_MARGIN * extent, angle)
            along = mesh[EYE_CORNERS["left"][0]] - mesh[EYE_CORNERS["right"][0]]
            angle = float(np.degrees(np.arctan2(along[1], along[0])))
            upright = mesh @ _rotation(angle)
            low, high = upright.min(axis=0), upright.max(axis=0)
            centre, extent = _rotation(angle) @ ((low + high) / 2), float((high - low).max())
        eyes = {side: self._eye(image, mesh, side) for side in EYE_CORNERS}
        return FaceLandmarks(
            points=ibug_68(mesh),
            eyelids={side: contour for side, (contour, _) in eyes.items()},
            irises={side: iris for side, (_, iris) in eyes.items()},
            score=score,
        )

    def _detect(self, image: np.ndarray, left: int, top: int) -> np.ndarray:
        """Boxes and scores (k, 5) in a part of a picture whose corner is at (left, top)."""
        height, width = image.shape[:2]
        side = max(height, width)
        square, back = _crop(image, np.array([width, height]) / 2, side, 0.0, _DETECTOR_SIDE)
        scores, boxes = self._run("face_detection", square * 2 - 1, ("classificators", "regressors"))
        scores = 1 / (1 + np.exp(-np.clip(scores.ravel(), -50, 50)))
        sure = scores > _SURE
        raw, anchors = boxes.reshape(-1, 16)[sure], _anchors()[sure]
        centre, size = raw[:, :2] + anchors, raw[:, 2:4]
        corner = back(centre - size / 2) + np.array([left, top])
        return np.column_stack([corner, size * side / _DETECTOR_SIDE, scores[sure]])

    def _mesh(self, image: np.ndarray, centre: np.ndarray, side: float, angle: float) -> tuple[np.ndarray, float]:
        """The 468 points (468, 2) in pixels, and how sure the network is."""
        crop, back = _crop(image, centre, side, angle, _MESH_SIDE)
        presence, points = self._run("face_landmark", crop, ("conv2d_31", "conv2d_21"))
        score = 1 / (1 + np.exp(-float(presence.ravel()[0])))
        return back(points.reshape(468, 3)[:, :2]), score

    def _eye(self, image: np.ndarray, mesh: np.ndarray, side: str) -> tuple[np.ndarray, np.ndarray]:
        """Contour (16, 2) of the lids, and middle and radius (3,) of the iris; the network knows left eyes."""
        outer, inner = mesh[list(EYE_CORNERS[side])]
        across = (outer - inner) if side == "left" else (inner - outer)
        angle = float(np.degrees(np.arctan2(across[1], across[0])))
        crop, back = _crop(image, (outer + inner) / 2, _EYE_MARGIN * float(np.hypot(*across)), angle, _EYE_SIDE)
        mirrored = side == "right"
        contour, iris = self._run(
            "iris_landmark", crop[:, ::-1] if mirrored else crop, ("output_eyes_contours_and_brows", "output_iris")
        )
        contour, iris = contour.reshape(-1, 3)[:16, :2], iris.reshape(5, 3)[:, :2]
        if mirrored:
            contour, iris = (points * (-1, 1) + (_EYE_SIDE, 0) for points in (contour, iris))
        contour, iris = back(contour), back(iris)
        closed = np.concatenate([contour[_LOWER][::-1], contour[_UPPER]])
        return closed, np.array([*iris[0], np.linalg.norm(iris[1:] - iris[0], axis=1).mean()])

    def _run(self, name: str, picture: np.ndarray, outputs: tuple[str, ...]) -> tuple[np.ndarray, ...]:
        network = self._networks[name]
        network.setInput(cv2.dnn.blobFromImage(np.ascontiguousarray(picture)))
        return network.forward(outputs)

    @cached_property
    def _networks(self) -> dict[str, Any]:
        return {name: read_network(name) for name in ("face_detection", "face_landmark", "iris_landmark")}


def read_network(name: str) -> Any:
    """A cached model as an OpenCV network; see `models.read` for what it raises."""
    # From memory OpenCV would take its new engine, which cannot run these.
    return cv2.dnn.readNetFromTFLite(str(models.path(name)), engine=cv2.dnn.ENGINE_CLASSIC)


def _anchors() -> np.ndarray:
    """Middles (896, 2) of the detector's anchors, in its pixels."""
    layers = []
    for stride, count in _ANCHORS:
        cells = (np.arange(_DETECTOR_SIDE // stride) + 0.5) * stride
        x, y = np.meshgrid(cells, cells)
        layers.append(np.repeat(np.stack([x.ravel(), y.ravel()], axis=1), count, axis=0))
    return np.concatenate(layers)


def _rotation(degrees: float) -> np.ndarray:
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[cos, -sin], [sin, cos]])


def _crop(image: np.ndarray, centre: np.ndarray, side: float, angle: float, pixels: int) -> tuple[np.ndarray, Any]:
    """A turned square of a picture, (pixels, pixels, 3) float32 in 0 to 1, and what takes its points back."""
    scale = side / pixels
    turn = _rotation(angle) * scale

    def back(points: np.ndarray) -> np.ndarray:
        return (points - pixels / 2) @ turn.T + centre

    # Middles of pixels are at halves, which OpenCV counts as whole numbers.
    matrix = np.column_stack([turn, back(np.array([0.5, 0.5])) - 0.5])
    shrunk, factor = image, 1.0
    if scale > 2:  # sampling every few pixels would see noise
        factor = 2 / scale
        shrunk = cv2.resize(image, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
        matrix = matrix * factor
        matrix[:, 2] += 0.5 * factor - 0.5
    crop = cv2.warpAffine(shrunk, matrix, (pixels, pixels), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP)
    return crop.astype(np.float32) / 255, back
