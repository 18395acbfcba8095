"""Coarse reconstruction: model coefficients, light and pose that explain a picture (section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import torch
from scipy import sparse
from scipy.spatial.transform import Rotation

from ..face.model import FaceModel
from ..face.template import PARTS
from ..geometry.camera import Camera
from ..geometry.visibility import visible
from ..portrait.landmarks import slid
from .shading import shade, vertex_normals
from .template import AvatarTemplate

LANDMARK_MM, _COLOUR = 1.2, 0.08  # standard deviations of what a landmark and a pixel may be off
_PIXELS = 150.0  # how many independent pixels a face counts as
_PRIOR = {"identity": 1.0, "expression": 1.0, "texture": 1.0}  # weights of equation 6
_JAW, _JAW_WEIGHT = slice(0, 17), 0.3  # landmarks of the contour, which no vertex has for certain
_FAR_SIDE = 30.0  # degrees of turning by which the far half of the contour counts no more
WHOLE = (70, 60)  # steps with landmarks alone, then with colours too, from the mean face
_ADJUST_STEPS = 200
_SLIDE, _REFRESH = 5, 20  # steps between new places along contours, and between looks at what is visible
_RATE = 0.08
USUAL_LIGHT = (3.0, 0.2, 0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # from above and before


@dataclass(frozen=True, eq=False)
class CoarseFit:
    """What a picture was explained by: the ``x`` of section 3.1.2.

    Parameters
    ----------
    identity, expression : arrays
        Weights of the bilinear model.
    texture : (k,) array
        Of the albedo basis.
    light : (9,) array
        Spherical-harmonics coefficients.
    camera : Camera
    vertices : (n, 3) array
        The coarse mesh, millimetres.
    """

    identity: np.ndarray
    expression: np.ndarray
    texture: np.ndarray
    light: np.ndarray
    camera: Camera
    vertices: np.ndarray


def landmark_weights(camera: Camera | None = None) -> np.ndarray:
    """The omega_n of equation 4, (68,): the contour counts less, its far half less still once the head is turned."""
    weights = np.ones(68)
    weights[_JAW] = _JAW_WEIGHT
    if camera is not None:
        far = slice(0, 8) if camera.yaw < 0 else slice(9, 17)
        weights[far] *= max(0.0, 1 - abs(camera.yaw) / _FAR_SIDE)
    return weights


class CoarseFitter:
    """Fits one face model and albedo to pictures.

    Parameters
    ----------
    model : FaceModel
    template : AvatarTemplate
    """

    def __init__(self, model: FaceModel, template: AvatarTemplate) -> None:
        self._model, self._template = model, template
        shape, bilinear = model.template, model.bilinear
        self._skin = np.flatnonzero(shape.parts == PARTS.index("skin"))
        number_of = np.full(shape.coarse_count, -1)
        number_of[self._skin] = np.arange(len(self._skin))
        faces = number_of[shape.coarse_faces]
        self._faces = faces[(faces >= 0).all(axis=1)]
        rows = shape.subdivision[np.concatenate([self._skin, model.landmarks])]  # fine vertices begin with the coarse
        self._mean = _tensor(_applied(rows, bilinear.mean[:, None])[:, 0])
        self._basis = _tensor(_applied(rows, bilinear.basis).T)
        self._core = _tensor(bilinear.core)
        self._centres = (_tensor(model.mean_identity), _tensor(model.expression_weights("neutral")))
        self._spreads = tuple(_tensor(rows.std(axis=0)) for rows in (bilinear.identities, bilinear.expressions))
        self._albedo = _tensor(template.albedo[self._skin])
        self._albedo_basis = _tensor(template.albedo_basis[:, self._skin])

    def fit(
        self,
        image: np.ndarray,
        landmarks: np.ndarray,
        confidence: np.ndarray,
        start: CoarseFit | None = None,
        steps: tuple[int, int] = WHOLE,
    ) -> CoarseFit:
        """Minimise equation 3 on one picture: landmarks first, then colours too.

        Parameters
        ----------
        image : (H, W, 3) uint8 array
        landmarks : (68, 2) array
            Pixels.
        confidence : (H, W) array
            How sure each pixel is of the face, 0 to 1: ``A_m`` of equation 5.
        start : CoarseFit, optional
            Where to begin, as from a network, with the camera that suits the landmarks; by default the mean face.
        steps : (int, int)
            How many with landmarks alone, and how many with colours too.

        Returns
        -------
        CoarseFit
        """
        picture, sure = as_tensors(image, confidence)
        start = self.mean_face(landmarks) if start is None else self._aligned(start, landmarks)
        unknowns = self.unknowns(start)
        weights = _tensor(landmark_weights(start.camera))
        optimiser = torch.optim.Adam(unknowns.values(), lr=_RATE)
        seen = None
        for step in range(sum(steps)):
            optimiser.zero_grad()
            if step >= steps[0] and (step - steps[0]) % _REFRESH == 0:
                seen = self.visible(unknowns)
            if step % _SLIDE == 0:
                wanted = _tensor(slid(self.landmarks(unknowns).numpy(), landmarks))
            self.loss(unknowns, wanted, weights, picture, sure, seen).backward()
            optimiser.step()
        return self.result(unknowns)

    def loss(
        self,
        unknowns: dict[str, torch.Tensor],
        wanted: torch.Tensor,
        weights: torch.Tensor,
        picture: torch.Tensor,
        sure: torch.Tensor,
        seen: torch.Tensor | None,
    ) -> torch.Tensor:
        """Equation 3, as the negative logarithm of a probability; of several pictures, the sum.

        Parameters
        ----------
        unknowns : dict of tensors
            "identity", "expression" and "texture" in standard deviations, "light" (9,), "turn" (3,) as axis times
            angle, "scale" as its logarithm, "shift" (2,) in centimetres; of several pictures, one row (b, ...) each.
        wanted, weights : ([b,] 68, 2) and (68,) tensors
            Landmarks in pixels, and how much each counts.
        picture, sure : (b, 3, H, W) and (b, 1, H, W) tensors
            Colours and confidence, 0 to 1.
        seen : ([b,] n) bool tensor, optional
            Which vertices are visible, see `visible`; without it colours do not count.
        """
        points = self.points(unknowns)
        projected, rotation = _project(points, unknowns)
        millimetre = unknowns["scale"].detach().exp()[..., None, None]
        off = ((projected[..., len(self._skin) :, :] - wanted) / millimetre).square().sum(dim=-1)
        loss = 0.5 * (weights * off).sum() / LANDMARK_MM**2
        for name, weight in _PRIOR.items():
            loss = loss + 0.5 * weight * unknowns[name].square().sum()
        if seen is not None and seen.any():
            loss = loss + self._photometric(points, projected, rotation, unknowns, picture, sure, seen)
        return loss

    def adjusted(self, fit: CoarseFit, landmarks: np.ndarray, identity: bool) -> CoarseFit:
        """The fit with its coefficients moved until landmarks are nearest: equation 7, which the paper compares with.

        Parameters
        ----------
        fit : CoarseFit
        landmarks : (68, 2) array
            Pixels.
        identity : bool
            Move the identity too, not the expression alone.
        """
        unknowns = self.unknowns(fit)
        moved = [unknowns[name] for name in (("identity", "expression") if identity else ("expression",))]
        optimiser = torch.optim.Adam(moved, lr=_RATE)
        weights, wanted = _tensor(landmark_weights(fit.camera)), _tensor(landmarks)
        for _ in range(_ADJUST_STEPS):
            optimiser.zero_grad()
            projected, _ = _project(self.points(unknowns)[len(self._skin) :], unknowns)
            (weights * (projected - wanted).norm(dim=1)).sum().backward()
            optimiser.step()
        return self.result(unknowns)

    def coarse(self, identity: np.ndarray, expression: np.ndarray) -> np.ndarray:
        """The coarse mesh (n, 3) float64 of bilinear weights."""
        return self._model.coarse(identity, expression).astype(np.float64)

    @property
    def skin_size(self) -> int:
        """How many vertices the skin has, of which `visible` tells."""
        return len(self._skin)

    @property
    def sizes(self) -> dict[str, int]:
        """How many numbers each of the unknowns is, by name; see `loss`."""
        sizes = {"identity": len(self._centres[0]), "expression": len(self._centres[1])}
        return sizes | {"texture": len(self._albedo_basis), "light": 9, "turn": 3, "scale": 1, "shift": 2}

    def unknowns(self, fit: CoarseFit) -> dict[str, torch.Tensor]:
        """What `loss` takes for a fit, as leaves that gradients reach."""
        values = {
            name: (_tensor(getattr(fit, name)) - centre) / spread
            for name, centre, spread in zip(("identity", "expression"), self._centres, self._spreads, strict=True)
        }
        values["texture"], values["light"] = _tensor(fit.texture), _tensor(fit.light)
        values["turn"] = _turn_vector(fit.camera.rotation)
        values["scale"] = torch.tensor(float(np.log(fit.camera.scale)))
        # Centimetres, the size of the other steps.
        values["shift"] = _tensor(fit.camera.translation / fit.camera.scale / 10)
        return {name: value.clone().requires_grad_() for name, value in values.items()}

    def mean_face(self, landmarks: np.ndarray) -> CoarseFit:
        """The mean face with the camera that brings it nearest to landmarks (68, 2): where a fit begins."""
        rest = self._model.mean[self._model.landmarks].astype(np.float64)
        camera = Camera.from_affine(rest, landmarks, landmark_weights())
        u, v = (centre.numpy() for centre in self._centres)
        return CoarseFit(u, v, np.zeros(len(self._albedo_basis)), np.array(USUAL_LIGHT), camera, self.coarse(u, v))

    def _aligned(self, fit: CoarseFit, landmarks: np.ndarray) -> CoarseFit:
        """A fit with the camera that brings its head nearest to landmarks (68, 2)."""
        points = (self._model.template.subdivision @ fit.vertices)[self._model.landmarks]
        return replace(fit, camera=Camera.from_affine(points, landmarks, landmark_weights(fit.camera)))

    def points(self, unknowns: dict[str, torch.Tensor]) -> torch.Tensor:
        """The skin's vertices, then the landmarks, of heads in their own frame: ([b,] n + 68, 3) millimetres."""
        u, v = (
            centre + spread * unknowns[name]
            for name, centre, spread in zip(("identity", "expression"), self._centres, self._spreads, strict=True)
        )
        code = torch.einsum("...j,dij,...i->...d", v, self._core, u)
        return (self._mean + code @ self._basis).unflatten(-1, (-1, 3))

    def _photometric(
        self,
        points: torch.Tensor,
        projected: torch.Tensor,
        rotation: torch.Tensor,
        unknowns: dict[str, torch.Tensor],
        picture: torch.Tensor,
        sure: torch.Tensor,
        seen: torch.Tensor,
    ) -> torch.Tensor:
        """Equation 5 over the visible vertices instead of the pixels; both count every part of the face once."""
        height, width = picture.shape[2:]
        count = len(self._skin)
        some = seen.reshape(-1, count).any(dim=0).nonzero()[:, 0]
        normals = vertex_normals(points[..., :count, :], self._faces_tensor)[..., some, :] @ rotation.mT
        albedo = self._albedo[some] + torch.tensordot(unknowns["texture"], self._albedo_basis[:, some], dims=1)
        rendered = shade(albedo, normals, unknowns["light"])
        at = projected[..., some, :] / torch.tensor([width / 2, height / 2]) - 1
        at = at.reshape(len(picture), 1, len(some), 2)
        given = torch.nn.functional.grid_sample(picture, at, align_corners=False)[:, :, 0].mT.reshape(rendered.shape)
        trust = torch.nn.functional.grid_sample(sure, at.detach(), align_corners=False).reshape(normals.shape[:-1])
        # What is seen aslant covers fewer pixels.
        trust = trust * normals[..., 2].detach().clamp(min=0) * seen[..., some]
        off = (rendered - given).square().mean(dim=-1)
        off = off / (1 + off / (3 * _COLOUR) ** 2)  # hair, glasses and highlights are no skin
        mean = (trust * off).sum(dim=-1) / trust.sum(dim=-1).clamp(min=1)
        return 0.5 * _PIXELS * mean.sum() / _COLOUR**2

    @property
    def _faces_tensor(self) -> torch.Tensor:
        return torch.from_numpy(self._faces.astype(np.int64))

    def visible(self, unknowns: dict[str, torch.Tensor]) -> torch.Tensor:
        """Which vertices of the skin (n,) the camera of one picture sees, for `loss`."""
        with torch.no_grad():
            points = self.points(unknowns)
            turn = rotation_of(unknowns["turn"]).numpy().astype(np.float64)
        skin = points[: len(self._skin)].numpy().astype(np.float64)
        facing = vertex_normals(torch.from_numpy(skin), self._faces_tensor).numpy() @ turn[2] > 0.1
        facing[facing] = visible(skin[facing], skin, self._faces, turn, tolerance=2.0)
        return torch.from_numpy(facing)

    def landmarks(self, unknowns: dict[str, torch.Tensor]) -> torch.Tensor:
        """The heads' landmarks ([b,] 68, 2) in pixels, without gradients."""
        with torch.no_grad():
            return _project(self.points(unknowns)[..., len(self._skin) :, :], unknowns)[0]

    def _camera(self, unknowns: dict[str, torch.Tensor]) -> Camera:
        rotation = rotation_of(unknowns["turn"]).detach().numpy().astype(np.float64)
        scale = float(unknowns["scale"].detach().exp())
        return Camera(scale, rotation, 10 * scale * unknowns["shift"].detach().numpy().astype(np.float64))

    def result(self, unknowns: dict[str, torch.Tensor]) -> CoarseFit:
        """What unknowns (see `loss`) stand for."""
        values = {name: value.detach().numpy() for name, value in unknowns.items()}
        u, v = (
            (centre + spread * unknowns[name].detach()).numpy()
            for name, centre, spread in zip(("identity", "expression"), self._centres, self._spreads, strict=True)
        )
        return CoarseFit(u, v, values["texture"], values["light"], self._camera(unknowns), self.coarse(u, v))


def _project(points: torch.Tensor, unknowns: dict[str, torch.Tensor]) -> tuple[torch.Tensor, torch.Tensor]:
    """Pixels ([b,] r, 2) of points ([b,] r, 3), and the rotations ([b,] 3, 3)."""
    rotation, scale = rotation_of(unknowns["turn"]), unknowns["scale"].exp()[..., None, None]
    seen = points @ rotation[..., :2, :].mT * torch.tensor([1.0, -1.0])
    return scale * (seen + 10 * unknowns["shift"][..., None, :]), rotation


def as_tensors(image: np.ndarray, confidence: np.ndarray) -> tuple[torch.Tensor, torch.Tensor]:
    """A picture (H, W, 3) uint8 and a confidence (H, W) as `CoarseFitter.loss` takes them."""
    return _tensor(image.transpose(2, 0, 1)[None] / 255.0), _tensor(confidence[None, None])


def rotation_of(turn: torch.Tensor) -> torch.Tensor:
    """Rotations ([b,] 3, 3) by vectors ([b,] 3): their axis, and as their length the angle in radians."""
    x, y, z = turn.unbind(-1)
    zero = torch.zeros_like(x)
    crossed = torch.stack([zero, -z, y, z, zero, -x, -y, x, zero], dim=-1)
    return torch.linalg.matrix_exp(crossed.unflatten(-1, (3, 3)))


def _turn_vector(rotation: np.ndarray) -> torch.Tensor:
    return _tensor(Rotation.from_matrix(rotation).as_rotvec())


def _applied(rows: sparse.csr_matrix, columns: np.ndarray) -> np.ndarray:
    """Fine rows of columns (3 n, k) of coarse coordinates: (3 r, k)."""
    k = columns.shape[1]
    return np.asarray(rows @ columns.reshape(-1, 3 * k)).reshape(-1, k)


def _tensor(values: np.ndarray) -> torch.Tensor:
    return torch.from_numpy(np.ascontiguousarray(values, dtype=np.float32))
