"""A caricature from the landmarks of a picture: Algorithm 1 of Alive Caricature (Wu et al. 2018)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ..face.face import Face
from ..face.model import FaceModel
from ..geometry.camera import Camera
from .head import DeformableHead
from .jaw import JAW, JawMatch
from .landmarks import FEWEST, as_landmarks, as_weights, check_orientation, check_spread
from .problem import Problem

PULL = 60.0  # lambda of equation 14, in this package's millimetres: landmarks are met to a millimetre or less
ITERATIONS = 6


@dataclass(frozen=True, eq=False)
class Step:
    """Where a fit stands.

    Parameters
    ----------
    iteration : int
        From 1 on.
    energy : float
        Of equation 14, square millimetres.
    vertices : (V, 3) array
    camera : Camera
    """

    iteration: int
    energy: float
    vertices: np.ndarray
    camera: Camera


@dataclass(frozen=True, eq=False)
class CaricatureFit:
    """A head fitted to landmarks.

    Parameters
    ----------
    model : FaceModel
    vertices : (V, 3) float32 array
        Of the model's topology, in millimetres and its frame.
    camera : Camera
    landmarks : (68, 2) array
        As given, in pixels.
    landmark_weights : (68,) array
    landmark_vertices : (68,) int array
        Where on the head each was seen at last.
    weights : (2, k) array
        Of the rotations and of the stretches of each example of the deformation space, `examples`.
    examples : tuple of str
    energies : tuple of float
        After each iteration.
    """

    model: FaceModel
    vertices: np.ndarray
    camera: Camera
    landmarks: np.ndarray
    landmark_weights: np.ndarray
    landmark_vertices: np.ndarray
    weights: np.ndarray
    examples: tuple[str, ...]
    energies: tuple[float, ...]

    @property
    def scale(self) -> float:
        """Pixels to the millimetre."""
        return self.camera.scale

    @property
    def rotation(self) -> np.ndarray:
        """From the head's frame to the viewer's, (3, 3)."""
        return self.camera.rotation

    @property
    def translation(self) -> np.ndarray:
        """Where the head's origin is in the picture, (2,) pixels."""
        return self.camera.translation

    @property
    def face(self) -> Face:
        """The head as a `Face`."""
        return Face(self.model, self.vertices)

    def project(self) -> np.ndarray:
        """The head's landmarks in the picture, (68, 2) pixels."""
        return self.camera.project(self.vertices[self.landmark_vertices])

    @property
    def errors(self) -> np.ndarray:
        """Distance (68,) in pixels between each given landmark and the head's, those of weight 0 too."""
        return np.linalg.norm(self.project() - self.landmarks, axis=1)

    @property
    def rmse(self) -> float:
        """Root of the mean squared error in pixels over the landmarks that took part (equation 20)."""
        return float(np.sqrt((self.errors[self.landmark_weights > 0] ** 2).mean()))


def fit(
    landmarks: Any,
    weights: Any = None,
    model: FaceModel | None = None,
    *,
    start: CaricatureFit | None = None,
    iterations: int = ITERATIONS,
    pull: float = PULL,
    progress: Callable[[Step], Any] | None = None,
) -> CaricatureFit:
    """The exaggerated head that the landmarks of a caricature show.

    Vertices, weights of the deformation space and a weak-perspective camera are bettered in turn, from the mean face
    on; which vertices the jaw's landmarks are at is found anew in each iteration, since in a picture they lie on the
    silhouette of the posed face.

    Parameters
    ----------
    landmarks : (68, 2) array-like
        Pixels, y down, in iBUG order.
    weights : (68,) array-like, optional
        How much each landmark counts, 1 by default; only their ratios matter. One of weight 0 takes no part, and may be
        anything.
    model : FaceModel, optional
        The shipped one by default.
    start : CaricatureFit, optional
        A fit of the same model to landmarks near by, to go on from.
    iterations : int
    pull : float
        lambda of equation 14: square millimetres of deformation that a landmark's square millimetre is worth.
    progress : callable, optional
        Called with a `Step` after each iteration.

    Returns
    -------
    CaricatureFit

    Raises
    ------
    ValueError
        If landmarks or weights have another shape, are not finite, lie in a point or on a line, or show a face that is
        mirrored or upside down; or another parameter is none.

    References
    ----------
    Wu, Zhang, Lai, Zheng and Cai, "Alive Caricature from 2D to 3D", CVPR 2018, section 4.
    """
    counts = as_weights(weights)
    landmarks = as_landmarks(landmarks, counts)
    check_spread(landmarks[counts > 0])
    _check_settings(start, iterations, pull)
    head = deformable_head(model or _shipped())
    state = _Fitting(head, landmarks, counts, pull, start)
    energies = []
    for iteration in range(1, iterations + 1):
        energies.append(state.iterate())
        if progress is not None:
            progress(Step(iteration, energies[-1], state.vertices, state.camera))
    return state.result(tuple(energies))


def _check_settings(start: Any, iterations: Any, pull: Any) -> None:
    if start is not None and not isinstance(start, CaricatureFit):
        raise ValueError(f"a fit starts from a CaricatureFit; given {type(start).__name__}")
    if not isinstance(iterations, int | np.integer) or isinstance(iterations, bool) or iterations < 1:
        raise ValueError(f"a fit has a whole number of iterations, at least one; given {iterations!r}")
    if not isinstance(pull, int | float | np.number) or not (np.isfinite(pull) and pull > 0):
        raise ValueError(f"the pull of landmarks is a positive number; given {pull!r}")


@lru_cache(maxsize=2)
def deformable_head(model: FaceModel) -> DeformableHead:
    """What fits to heads of a model need; made once a model."""
    return DeformableHead(model)


@lru_cache(maxsize=1)
def _shipped() -> FaceModel:
    return FaceModel.load()


class _Fitting:
    """A fit under way: the vertices, the weights and the camera of Algorithm 1."""

    def __init__(
        self,
        head: DeformableHead,
        landmarks: np.ndarray,
        counts: np.ndarray,
        pull: float,
        start: CaricatureFit | None,
    ) -> None:
        if start is not None and start.model is not head.model:
            raise ValueError("a fit goes on from one of the same model")
        self._head, self._landmarks, self._pull = head, landmarks, pull
        self._given, self._counts = counts, counts / counts[counts > 0].mean()
        self._places = head.model.landmarks.copy()
        if start is None:
            self.weights = np.zeros((2, head.space.size))
            self.vertices = head.model.mean
            # Where the jaw is seen depends on the camera, and can wait if there is enough else.
            seen = (counts > 0) & (np.arange(len(counts)) >= JAW)
            seen = seen if seen.sum() >= FEWEST else counts > 0
            points = self.vertices[self._places[seen]].astype(np.float64)
            self.camera = Camera.fitted(points, landmarks[seen], self._counts[seen])
            check_orientation(self.camera)
        else:
            self.weights, self.vertices = start.weights, start.vertices
            self.camera = start.camera
        self._see(None)

    def iterate(self) -> float:
        """One round of Algorithm 1; the energy after it."""
        problem = self._problem()
        self.camera = problem.camera(self.weights, self.camera)
        self.weights = problem.weights(self.weights, self.camera, iterations=1)
        energy = problem.energy(self.weights, self.camera)
        self._take(problem)
        return energy

    def result(self, energies: tuple[float, ...]) -> CaricatureFit:
        """The last step for the vertices, where the jaw is seen by now."""
        self._take(self._problem())
        return CaricatureFit(
            self._head.model,
            self.vertices,
            self.camera,
            self._landmarks,
            self._given,
            self._places,
            self.weights,
            self._head.names,
            energies,
        )

    def _points(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Places on the head (l, 3), in the picture (l, 2), and weights (l,) of the landmarks that count."""
        used = self._counts > 0
        points = self.vertices[self._places[used]].astype(np.float64)
        return points, self._landmarks[used], self._counts[used]

    def _see(self, before: JawMatch | None) -> None:
        """Find the jaw's landmarks on the silhouette."""
        self._jaw = self._head.jaw.match(self.vertices, self.camera, self._landmarks[:JAW], self._counts[:JAW], before)
        self._places = np.concatenate([self._jaw.vertices, self._places[JAW:]])

    def _problem(self) -> Problem:
        used = self._counts > 0
        vertices = np.concatenate([self._places[used], self._jaw.outline])
        pixels = np.concatenate([self._landmarks[used], self._jaw.targets])
        counts = np.concatenate([self._counts[used], self._jaw.weights])
        return Problem(self._head.space, self._head.rows(vertices), pixels, self._pull * counts)

    def _take(self, problem: Problem) -> None:
        self.vertices = self._head.vertices(problem.vertices(self.weights, self.camera))
        self.camera = self.camera.centred(*self._points())
        self._see(self._jaw)
