"""Fine reconstruction: Laplacian deformation that brings landmarks where the picture has them (section 3.2)."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu
from scipy.spatial import KDTree

from ..face.model import FaceModel
from ..face.template import PARTS
from ..geometry.deformation_transfer import DeformationTransfer, deformation_gradients
from ..portrait.landmarks import FaceLandmarks, slid
from ..sketch import arc_length, resample
from .coarse import CoarseFit, landmark_weights

_LAMBDA = 2.0  # of equation 10, against Laplacians of a mesh in millimetres
_STAY, _STAY_MM = 0.02, (15.0, 60.0)  # weight of what stays, away from the anchors, and where it sets in and is whole
_LOWERED = {
    "upper teeth": 4.5,
    "lower teeth": 2.5,
    "tongue": 4.0,
}  # mm: lips show some teeth
_HELD_SHARE = 0.15  # of the vertices, those that an expression moves least


class FineFitter:
    """Aligns heads of one model with landmarks.

    Parameters
    ----------
    model : FaceModel
    """

    def __init__(self, model: FaceModel) -> None:
        self._model = model
        template = model.template
        self._soft, self._faces = template.soft
        edges = np.unique(np.sort(_quad_edges(template.quads), axis=1), axis=0)
        number_of = np.full(template.coarse_count, -1)
        number_of[self._soft] = np.arange(len(self._soft))
        edges = number_of[edges]
        edges = edges[(edges >= 0).all(axis=1)]
        n = len(self._soft)
        ones = np.ones(2 * len(edges))
        neighbours = sparse.csr_matrix((ones, (edges.ravel(), edges[:, ::-1].ravel())), shape=(n, n))
        valence = np.maximum(np.ravel(neighbours.sum(axis=1)), 1)
        laplacian = sparse.identity(n) - sparse.diags(1 / valence) @ neighbours  # equation 9
        self._energy = (laplacian.T @ laplacian).tocsr()
        about = KDTree(model.mean[model.landmarks]).query(model.mean[self._soft])[0]
        stay = np.clip((about - _STAY_MM[0]) / (_STAY_MM[1] - _STAY_MM[0]), 0.0, 1.0)
        # Equation 10 says nothing of what is far from all landmarks: skull and neck would be pulled along.
        self._energy += _STAY * sparse.diags(stay)
        self._lids = {side: _lid_anchors(model, side) for side in ("left", "right")}

    def fit(self, coarse: CoarseFit, marks: FaceLandmarks) -> np.ndarray:
        """The coarse mesh (n, 3) aligned with the marks of the picture that it was fitted to: equation 10.

        Anchors are the 68 landmarks and, where the lids' contours are known, the lids all along; they move in the
        picture and keep their depth (equation 11). Eyes, teeth and tongue follow the skin next to them.
        """
        camera, template = coarse.camera, self._model.template
        fine = template.subdivision @ coarse.vertices
        anchors, weights = self._model.landmarks, landmark_weights(camera)
        wanted = slid(camera.project(fine[anchors]), marks.points)
        for side, contour in marks.eyelids.items():
            vertices, share = self._lids[side]
            anchors = np.concatenate([anchors, vertices])
            wanted = np.concatenate([wanted, along_lids(contour, share)])
            weights = np.concatenate([weights, np.ones(len(vertices))])
        shift = camera.lift(wanted - camera.project(fine[anchors]))
        vertices = coarse.vertices.copy()
        moved = self._moved(anchors, shift, weights)
        vertices[self._soft] += moved
        return self._followed(vertices, moved)

    def neutral(self, vertices: np.ndarray, posed: np.ndarray, rest: np.ndarray) -> np.ndarray:
        """A head (n, 3) without the expression that leads from `rest` to `posed`, two heads (n, 3) of the model.

        The inverse expression is carried over by deformation transfer (section 3.3).
        """
        back = rest - posed
        amount = np.linalg.norm(back[self._soft], axis=1)
        held = amount <= np.quantile(amount, _HELD_SHARE)
        gradients = deformation_gradients(posed[self._soft], rest[self._soft], self._faces)
        relaxed = vertices + back
        start = vertices[self._soft].copy()
        start[held] += back[self._soft][held]
        relaxed[self._soft] = DeformationTransfer(start, self._faces, held)(gradients)
        relaxed[self._soft] += self._closing(relaxed, rest)
        return relaxed

    def _closing(self, vertices: np.ndarray, rest: np.ndarray) -> np.ndarray:
        """How the skin moves (s, 3) if the lips of a head (n, 3) are to lie on each other as they do in `rest`.

        The line between them bends as it does there: what is left of a smile would turn the corners down.
        """
        refine, curves = self._model.template.subdivision, self._model.curves
        upper, lower = curves["mouth_upper"], curves["mouth_lower"]
        across = np.rint(np.linspace(0, len(lower) - 1, len(upper))).astype(int)
        fine, wanted = refine @ vertices, refine @ rest
        excess = (fine[upper] - fine[lower[across]]) - (wanted[upper] - wanted[lower[across]])
        line, resting = ((head[upper, 1] + head[lower[across], 1]) / 2 for head in (fine, wanted))
        bend = np.zeros((len(upper), 3))
        bend[:, 1] = (resting - resting.mean()) - (line - line.mean())
        still = np.delete(self._model.landmarks, np.arange(48, 68))
        anchors = np.concatenate([upper, lower[across], still])
        shift = np.concatenate([bend - excess / 2, bend + excess / 2, np.zeros((len(still), 3))])
        return self._moved(anchors, shift, np.ones(len(anchors)))

    def _moved(self, anchors: np.ndarray, shift: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Displacements (s, 3) of the skin that bring fine vertices (k,) by shifts (k, 3): equation 10."""
        rows = self._model.template.subdivision[anchors][:, self._soft].tocsr().astype(np.float64)
        pull = _LAMBDA * rows.T @ sparse.diags(weights)
        # The unknown is the displacement: what preserves the Laplacians of the shape preserves those of zero.
        return splu((self._energy + pull @ rows).tocsc()).solve(pull @ shift)

    def _followed(self, vertices: np.ndarray, moved: np.ndarray) -> np.ndarray:
        """A head (n, 3) with teeth and tongue where its mouth has gone."""
        parts = self._model.template.parts
        mouth = parts[self._soft] == PARTS.index("mouth")
        shift = moved[mouth].mean(axis=0) if mouth.any() else np.zeros(3)
        teeth, tongue = parts == PARTS.index("teeth"), parts == PARTS.index("tongue")
        upper = teeth & (vertices[:, 1] > vertices[teeth, 1].mean()) if teeth.any() else teeth
        for name, members in {"upper teeth": upper, "lower teeth": teeth & ~upper, "tongue": tongue}.items():
            vertices[members] += shift - (0, _LOWERED[name], 0)
        return vertices


def along_lids(contour: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Points (k, 2) of a lid contour at shares of its two halves: 0 to 1 of the lower lid, then 1 to 2 of the upper.

    Both halves run from the outer corner to the inner one; the contour (16, 2) begins at the outer corner and goes
    along the lower lid.
    """
    half = len(contour) // 2
    lower, upper = contour[: half + 1], np.concatenate([contour[:1], contour[half:][::-1]])
    places = np.linspace(0, 1, 101)
    curves = [resample(line, 101) for line in (lower, upper)]
    points = [
        np.stack([np.interp(share - number, places, curve[:, axis]) for axis in range(2)], axis=1)
        for number, curve in enumerate(curves)
    ]
    return np.where((share < 1)[:, None], *points)


def _lid_anchors(model: FaceModel, side: str) -> tuple[np.ndarray, np.ndarray]:
    """Fine vertices along both lids, and where of the contour each is; see `along_lids`."""
    vertices, shares = [], []
    for number, lid in enumerate(("lower", "upper")):
        path = model.curves[f"{side}_eye_{lid}"]
        points = model.mean[path]
        length = arc_length(points)
        share = length / length[-1]
        if abs(points[0, 0]) < abs(points[-1, 0]):  # from the outer corner
            share = 1 - share
        inner = (share > 0.04) & (share < 0.96)  # corners are landmarks already
        vertices.append(path[inner])
        shares.append(number + share[inner])
    return np.concatenate(vertices), np.concatenate(shares)


def _quad_edges(quads: np.ndarray) -> np.ndarray:
    edges = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    return edges[edges[:, 0] != edges[:, 1]]
