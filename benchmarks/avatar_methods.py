"""Ways to reconstruct a head from a portrait, and how far off they are: what `benchmarks.avatar` compares."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import torch

from sketchwidget import FaceModel
from sketchwidget.avatar.build import squared
from sketchwidget.avatar.coarse import WHOLE, CoarseFit, CoarseFitter
from sketchwidget.avatar.fine import FineFitter
from sketchwidget.avatar.network import PortraitNetwork
from sketchwidget.avatar.shading import shade, vertex_normals
from sketchwidget.avatar.stylize import EyeWarp, cartoon
from sketchwidget.avatar.template import AvatarTemplate
from sketchwidget.avatar.texture import TextureBaker
from sketchwidget.geometry.alignment import similarity
from sketchwidget.geometry.rasterise import rasterise
from sketchwidget.portrait import FaceLandmarks
from sketchwidget.portrait.landmarks import slid
from sketchwidget.training.portraits import KnownPortrait

LARGER_EYES = 0.45  # of the cartoons
SHORT = (15, 15)  # steps of a fit that begins near its end
PARTS = {
    "eyes": slice(36, 48),
    "nose": slice(27, 36),
    "brows": slice(17, 27),
    "mouth": slice(48, 68),
    "contour": slice(0, 17),
    "all": slice(0, 68),
}


@dataclass(frozen=True, eq=False)
class Case:
    """A portrait to reconstruct.

    Parameters
    ----------
    image : (S, S, 3) uint8 array
        The square that is worked on.
    marks : FaceLandmarks
    sure : (S, S) array
        How sure each pixel is of the face.
    known : (V, 3) array, optional
        The head that is seen.
    """

    image: np.ndarray
    marks: FaceLandmarks
    sure: np.ndarray
    known: np.ndarray | None = None

    @classmethod
    def of(cls, portrait: KnownPortrait) -> Case:
        """A rendered portrait."""
        marks = FaceLandmarks(portrait.landmarks)
        square, to_square, _ = squared(portrait.image, marks)
        mask, _, _ = squared(portrait.mask.astype(np.float32), marks)
        return cls(square, marks.moved(to_square), mask, portrait.vertices)

    def drawn(self) -> Case:
        """The same as a cartoon with eyes that no head of the model has."""
        warp = EyeWarp.of(self.marks, LARGER_EYES)
        return replace(self, image=cartoon(warp.picture(self.image)), marks=self.marks.moved(warp))


class Methods:
    """All ways to reconstruct.

    Parameters
    ----------
    model : FaceModel
    template : AvatarTemplate
    network : PortraitNetwork
    """

    def __init__(self, model: FaceModel, template: AvatarTemplate, network: PortraitNetwork) -> None:
        self._model, self._template, self._network = model, template, network
        self._coarse, self._fine = CoarseFitter(model, template), FineFitter(model)
        self._baker = TextureBaker(model, template, 512)
        self._front = (model.mean[:, 2] > 30) & (model.mean[:, 1] > model.mean[model.landmarks[8], 1])
        self._front &= model.template.fine_parts == 0

    def errors(self, case: Case) -> dict[str, dict[str, float]]:
        """Figures of each method by its name."""
        points, network = case.marks.points, self._network
        starts: dict[str, Callable[[], CoarseFit]] = {
            "coarse": lambda: self._coarse.fit(case.image, points, case.sure),
            "coarse, short": lambda: self._coarse.fit(case.image, points, case.sure, steps=SHORT),
            "network alone": lambda: network.predict(case.image, self._coarse),
        }
        for name, steps in {"network, then coarse, short": SHORT, "network, then coarse": WHOLE}.items():
            starts[name] = lambda steps=steps: self._coarse.fit(
                case.image, points, case.sure, network.predict(case.image, self._coarse), steps
            )
        found = {}
        for name, start in starts.items():
            fit, seconds = _timed(start)
            found[name] = self._figures(case, fit, self._refined(fit.vertices), self._shaded(fit), seconds)
            if name == "coarse":
                found |= dict(self._onwards(case, fit, seconds))
        return found

    def head(self, case: Case) -> np.ndarray:
        """The fine head (V, 3), aligned with the picture's landmarks, without its expression."""
        fit = self._coarse.fit(case.image, case.marks.points, case.sure)
        rest = self._coarse.coarse(fit.identity, self._model.expression_weights("neutral"))
        return self._refined(self._fine.neutral(self._fine.fit(fit, case.marks), fit.vertices, rest))

    def apart(self, one: np.ndarray, other: np.ndarray) -> float:
        """Mean distance of the fronts of two faces in millimetres, aligned."""
        scale, rotation, shift = similarity(one[self._front], other[self._front])
        moved = scale * one[self._front] @ rotation.T + shift
        return float(np.linalg.norm(moved - other[self._front], axis=1).mean())

    def _onwards(self, case: Case, fit: CoarseFit, seconds: float) -> Iterator[tuple[str, dict[str, float]]]:
        """What brings the landmarks of a coarse fit nearer: the paper's way, and those of its Table 2."""
        posed, more = _timed(lambda: self._fine.fit(fit, case.marks))
        fine = self._refined(posed)
        texture = self._baker(case.image, case.sure, fit, fine, [], case.marks)
        side = len(texture)
        at = np.clip((self._baker.uv * (1, -1) + (0, 1)) * side, 0, side - 1).astype(int)
        yield "fine", self._figures(case, fit, fine, texture[at[:, 1], at[:, 0]].astype(float), seconds + more)
        for name, identity in (("expression adjusted", False), ("identity and expression adjusted", True)):
            other, more = _timed(lambda identity=identity: self._coarse.adjusted(fit, case.marks.points, identity))
            yield name, self._figures(case, fit, self._refined(other.vertices), self._shaded(other), seconds + more)

    def _refined(self, coarse: np.ndarray) -> np.ndarray:
        return self._model.template.subdivision @ coarse

    def _figures(
        self, case: Case, fit: CoarseFit, vertices: np.ndarray, colours: np.ndarray, seconds: float
    ) -> dict[str, float]:
        points = fit.camera.project(vertices[self._model.landmarks])
        off = np.linalg.norm(points - slid(points, case.marks.points), axis=1)
        figures = {name: 100 * off[part].mean() / case.marks.eye_distance for name, part in PARTS.items()}
        if case.known is not None:
            figures["shape"] = self.apart(vertices, case.known)
        figures["photometric"] = self._photometric(case, fit, vertices, colours)
        return figures | {"seconds": seconds}

    def _shaded(self, fit: CoarseFit) -> np.ndarray:
        """Colours (V, 3), 0 to 255, of albedo and light."""
        fine = torch.from_numpy(self._refined(fit.vertices))
        albedo = self._template.albedo + np.tensordot(fit.texture, self._template.albedo_basis, axes=1)
        normals = vertex_normals(fine, torch.from_numpy(self._model.faces.astype(np.int64)))
        normals = normals @ torch.from_numpy(fit.camera.rotation.T)
        light = torch.from_numpy(fit.light.astype(np.float64))
        return np.clip(shade(torch.from_numpy(self._refined(albedo)), normals, light).numpy(), 0, 1) * 255

    def _photometric(self, case: Case, fit: CoarseFit, vertices: np.ndarray, colours: np.ndarray) -> float:
        """Mean Manhattan distance of colours, 0 to 1 a channel, over the front of the face."""
        faces = self._model.faces
        triangle, weights = rasterise(fit.camera.project(vertices), faces, case.sure.shape, fit.camera.depth(vertices))
        row, column = np.nonzero((triangle >= 0) & (case.sure > 0.5))
        corners = faces[triangle[row, column]]
        skin = self._front[corners].all(axis=1)
        drawn = (colours[corners] * weights[row, column][..., None]).sum(axis=1)
        return float(np.abs(drawn - case.image[row, column])[skin].sum(axis=1).mean() / 255)


def _timed(work: Callable[[], CoarseFit | np.ndarray]) -> tuple:
    """What some work gives, and the seconds of the processor that it took."""
    began = time.process_time()
    return work(), time.process_time() - began
