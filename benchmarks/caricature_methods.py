"""What Alive Caricature is compared with (section 5.2): linear and bilinear models fitted to landmarks, and ARAP."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import igl
import numpy as np

from sketchwidget import FaceModel
from sketchwidget.caricature import Camera, fit
from sketchwidget.caricature.fitting import deformable_head
from sketchwidget.caricature.jaw import JAW
from sketchwidget.face.exaggeration import LEVELS

_ROUNDS = 8  # of camera, jaw and weights in turn
_IDENTITIES, _EXPRESSIONS, _EXAGGERATED = 50, 16, 66  # components: as many as the bilinear model has
STRONG, WEAK = 10.0, 0.01  # square millimetres that a squared standard deviation of a weight is worth


@dataclass(frozen=True)
class Fitted:
    """A head fitted to landmarks: vertices (V, 3), its camera, and the vertices (68,) of the landmarks."""

    vertices: np.ndarray
    camera: Camera
    places: np.ndarray


Method = Callable[[np.ndarray, np.ndarray], Fitted]  # of landmarks (68, 2) and weights (68,)


def methods(model: FaceModel) -> dict[str, Method]:
    """All methods by name."""
    linear = {
        "3DMM": _Linear(model, *_morphable(model), STRONG),
        "3DMM (-)": _Linear(model, *_morphable(model), WEAK),
        "bilinear": _Bilinear(model),
        "C-3DMM": _Linear(model, *_exaggerated(model), WEAK),
    }
    deformed = {f"{name} + ARAP": _followed_by_arap(model, method) for name, method in linear.items()}
    return {**linear, **deformed, "ours": _ours(model)}


def _ours(model: FaceModel) -> Method:
    def fitted(landmarks: np.ndarray, weights: np.ndarray) -> Fitted:
        found = fit(landmarks, weights, model)
        return Fitted(found.vertices.astype(np.float64), found.camera, found.landmark_vertices)

    return fitted


def _codes(model: FaceModel, identities: np.ndarray, expressions: np.ndarray) -> np.ndarray:
    """Coefficients (i, e, k) in the model's basis of identities (i, p) in expressions (e, q)."""
    return np.einsum("kpq,ip,eq->iek", model.bilinear.core, identities, expressions, optimize=True)


def _components(codes: np.ndarray, count: int) -> np.ndarray:
    """Principal components (k, count) of centred codes (m, k), each as long as its standard deviation."""
    _, singular, axes = np.linalg.svd(codes - codes.mean(axis=0), full_matrices=False)
    return axes[:count].T * (singular[:count] / np.sqrt(len(codes)))


def _morphable(model: FaceModel) -> tuple[np.ndarray, np.ndarray]:
    """Mean and components: of people at rest, and of what expressions add (equation 16)."""
    bilinear = model.bilinear
    codes = _codes(model, bilinear.identities[::LEVELS], bilinear.expressions)
    rest = codes[:, model.expressions.index("neutral")]
    added = (codes - rest[:, None]).reshape(-1, codes.shape[-1])
    return rest.mean(axis=0), np.hstack([_components(rest, _IDENTITIES), _components(added, _EXPRESSIONS)])


def _exaggerated(model: FaceModel) -> tuple[np.ndarray, np.ndarray]:
    """Mean and components of all faces, those of every level of exaggeration among them."""
    codes = _codes(model, model.bilinear.identities, model.bilinear.expressions).reshape(-1, len(model.bilinear.core))
    return codes.mean(axis=0), _components(codes, _EXAGGERATED)


class _Fitting:
    """Camera, jaw and weights in turn, from the model's mean face on."""

    def __init__(self, model: FaceModel) -> None:
        self._model = model
        self._refine = model.template.subdivision.astype(np.float64).tocsr()
        self._jaw = deformable_head(model).jaw
        self._basis = model.bilinear.basis.reshape(-1, 3, model.bilinear.basis.shape[1])

    def _vertices(self, code: np.ndarray) -> np.ndarray:
        return self._refine @ (self._model.bilinear.mean.reshape(-1, 3) + self._basis @ code)

    def _start(self) -> np.ndarray:
        raise NotImplementedError

    def _better(self, project: Callable[[np.ndarray], np.ndarray], target: np.ndarray) -> np.ndarray:
        """A code nearer to a target; `project` takes codes (k, m) to what (n, m) of them is seen."""
        raise NotImplementedError

    def __call__(self, landmarks: np.ndarray, weights: np.ndarray) -> Fitted:
        used, places = weights > 0, self._model.landmarks.copy()
        vertices = self._vertices(self._start())
        inner = used & (np.arange(len(used)) >= JAW)
        camera = Camera.fitted(vertices[places[inner]], landmarks[inner], weights[inner])
        for _ in range(_ROUNDS):
            places[:JAW] = self._jaw.match(vertices, camera, landmarks[:JAW], weights[:JAW]).vertices
            camera = Camera.fitted(vertices[places[used]], landmarks[used], weights[used], camera)
            vertices = self._vertices(self._code(places[used], landmarks[used], camera))
            camera = Camera.fitted(vertices[places[used]], landmarks[used], weights[used], camera)
        places[:JAW] = self._jaw.match(vertices, camera, landmarks[:JAW], weights[:JAW]).vertices
        return Fitted(vertices, camera, places)

    def _code(self, places: np.ndarray, landmarks: np.ndarray, camera: Camera) -> np.ndarray:
        rows, plane = self._refine[places], camera.rotation[:2]

        def centred(seen: np.ndarray) -> np.ndarray:
            return (seen - seen.mean(axis=0)).reshape(-1, seen.shape[2])

        basis = (rows @ self._basis.reshape(len(self._basis), -1)).reshape(len(places), *self._basis.shape[1:])
        mean = rows @ self._model.bilinear.mean.reshape(-1, 3)
        target = (camera.targets(landmarks) - mean @ plane.T)[:, :, None]
        return self._better(lambda codes: centred(plane @ (basis @ codes)), centred(target)[:, 0])


class _Linear(_Fitting):
    """A linear model with a normal prior (equations 16 to 18)."""

    def __init__(self, model: FaceModel, mean: np.ndarray, components: np.ndarray, prior: float) -> None:
        super().__init__(model)
        self._mean, self._components, self._prior = mean, components, prior

    def _start(self) -> np.ndarray:
        return self._mean

    def _better(self, project: Callable[[np.ndarray], np.ndarray], target: np.ndarray) -> np.ndarray:
        design = project(self._components)
        left = target - project(self._mean[:, None])[:, 0]
        normal = design.T @ design + self._prior * np.eye(design.shape[1])
        return self._mean + self._components @ np.linalg.solve(normal, design.T @ left)


class _Bilinear(_Fitting):
    """The bilinear model by alternating least squares without any prior (equation 19)."""

    def _start(self) -> np.ndarray:
        model = self._model.bilinear
        self._expression = self._model.expression_weights("neutral")
        return model.core @ self._expression @ self._model.mean_identity

    def _better(self, project: Callable[[np.ndarray], np.ndarray], target: np.ndarray) -> np.ndarray:
        core = self._model.bilinear.core
        identity = np.linalg.lstsq(project(core @ self._expression), target, rcond=None)[0]
        self._expression = np.linalg.lstsq(project(np.einsum("kpq,p->kq", core, identity)), target, rcond=None)[0]
        return core @ self._expression @ identity


def _followed_by_arap(model: FaceModel, method: Method) -> Method:
    """A method's head, its landmarks pulled onto their targets as rigidly as possible (Sorkine and Alexa 2007)."""
    head = deformable_head(model)
    skin = np.unique(head.rows(np.arange(len(model.mean))).nonzero()[0])
    number = np.full(len(model.mean), -1)
    number[skin] = np.arange(len(skin))
    faces = number[model.faces[(number[model.faces] >= 0).all(axis=1)]].astype(np.int64)

    def fitted(landmarks: np.ndarray, weights: np.ndarray) -> Fitted:
        found = method(landmarks, weights)
        places = found.places[weights > 0]
        seen = found.vertices[places] @ found.camera.rotation.T
        seen[:, :2] = found.camera.targets(landmarks[weights > 0])
        # A vertex of the silhouette may serve two landmarks: it goes where the first is.
        held, first = np.unique(number[places], return_index=True)
        start = np.ascontiguousarray(found.vertices[skin])
        data = igl.ARAPData()
        data.max_iter = 10
        data.energy = igl.ARAP_ENERGY_TYPE_SPOKES_AND_RIMS
        igl.arap_precomputation(start, faces, 3, held.astype(np.int32), data)
        targets = np.ascontiguousarray((seen @ found.camera.rotation)[first])
        vertices = found.vertices.copy()
        vertices[skin] = igl.arap_solve(targets, data, start)
        return Fitted(vertices, found.camera, found.places)

    return fitted
