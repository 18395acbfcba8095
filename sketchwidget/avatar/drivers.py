"""What drives an avatar: landmarks that are tracked through a video, or somebody else's blendshape scores.

A driver is any iterable of weights by ARKit's names; `Performance.recorded` keeps what it gives.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from scipy.optimize import lsq_linear

from ..face.model import FaceModel
from ..geometry.camera import Camera
from ..portrait.landmarks import FaceDetector
from .coarse import landmark_weights
from .performance import FPS, Performance

_SMALL = 0.2  # of a millimetre for a weight: what landmarks hardly show stays at rest
_ROUNDS = 5  # of pose and weights in turn
_LEFT_OUT = ("eyeLook", "tongue", "cheekPuff")  # landmarks do not show them
_MAX_FRAMES = 10_000


def blendshape_scores(results: Iterable[Any]) -> Iterator[dict[str, float]]:
    """Weights from the results of the user's own MediaPipe Face Landmarker, frame by frame.

    Parameters
    ----------
    results : iterable
        Each with ``face_blendshapes``: for each face a list of categories with ``category_name`` and ``score``.
    """
    for result in results:
        faces = result.face_blendshapes
        frame = {category.category_name: float(category.score) for category in faces[0]} if faces else {}
        frame.pop("_neutral", None)
        yield frame


class LandmarkSolver:
    """Finds the weights of a rig that bring its landmarks nearest to tracked ones.

    Parameters
    ----------
    model : FaceModel
        Whose landmarks are tracked.
    rest : (V, 3) array
        The head at rest.
    rig : dict of (V, 3) arrays
    neutral : (68, 2) array, optional
        Tracked landmarks of the performer at rest, as in the first frame: what they differ by from the rig's own is
        taken off every frame, since performer and avatar have different faces.
    """

    def __init__(
        self, model: FaceModel, rest: np.ndarray, rig: Mapping[str, np.ndarray], neutral: np.ndarray | None = None
    ) -> None:
        self._names = [name for name in rig if not name.startswith(_LEFT_OUT)]
        self._rest = rest[model.landmarks].astype(np.float64)
        self._basis = np.stack([rig[name][model.landmarks] for name in self._names]).astype(np.float64)
        self._weights = landmark_weights()
        self._offset = np.zeros((68, 3))
        if neutral is not None:
            camera = Camera.from_affine(self._rest, neutral, self._weights)
            self._offset = camera.lift(neutral - camera.project(self._rest))

    def __call__(self, points: np.ndarray) -> dict[str, float]:
        """Weights, 0 to 1, of landmarks (68, 2) in pixels."""
        beta = np.zeros(len(self._names))
        rest = self._rest + self._offset
        root = np.sqrt(self._weights)[:, None]
        for _ in range(_ROUNDS):
            camera = Camera.from_affine(rest + np.tensordot(beta, self._basis, axes=1), points, self._weights)
            wanted = (points - camera.project(rest)) / camera.scale * root
            rows = (self._basis @ camera.rotation[:2].T) * (1, -1) * root
            system = np.concatenate([rows.reshape(len(beta), -1).T, _SMALL * np.eye(len(beta))])
            target = np.concatenate([wanted.ravel(), np.zeros(len(beta))])
            beta = lsq_linear(system, target, (0.0, 1.0), lsmr_tol="auto").x
        return dict(zip(self._names, beta.tolist(), strict=True))


def video_performance(
    path: str | os.PathLike[str],
    model: FaceModel,
    rest: np.ndarray,
    rig: Mapping[str, np.ndarray],
    detector: FaceDetector,
) -> Performance:
    """The expressions of the face in a video, as a performance; where no face is seen, the last ones are held.

    Parameters
    ----------
    path : path
        A video file that OpenCV reads; the face should be at rest in the first frame.
    model, rest, rig
        Of the avatar; see `LandmarkSolver`.
    detector : FaceDetector

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no video, or no face is in it.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"there is no video at {path}")
    video = cv2.VideoCapture(str(path))
    try:
        fps = video.get(cv2.CAP_PROP_FPS) or FPS
        solver, frames = None, []
        for _ in range(_MAX_FRAMES):
            read, frame = video.read()
            if not read:
                break
            image = cv2.cvtColor(frame, cv2.COLOR_BGR2RGB)
            boxes = detector.faces(image)
            if not len(boxes):
                frames.append(frames[-1] if frames else {})
                continue
            points = detector.landmarks(image, boxes[0]).points
            if solver is None:
                solver = LandmarkSolver(model, rest, rig, neutral=points)
            frames.append(solver(points))
    finally:
        video.release()
    if solver is None:
        raise ValueError(f"{path} is no video with a face in it" if frames else f"{path} is no video that can be read")
    return Performance.recorded(path.stem, frames, fps)
