"""Levels of exaggeration: a head's gradients scaled by its curvature, as caricaturists stress what stands out."""

from __future__ import annotations

import igl
import numpy as np
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from ..geometry.deformation_transfer import DeformationTransfer
from ..sketch import FEATURES
from .template import PARTS, Template
from .wrinkles import LIPS

POWERS = (0.0, 0.15, 0.3, 0.45)  # of the curvature, by level; the first level is the head as it is
LEVELS = len(POWERS)

_HELD_MM = 5.0  # about eyes and mouth
_ROUNDS = 3  # of smoothing the curvature over neighbours
_SHARPEST = 97.0  # percentile: beyond it curvature is noise
_BOUNDS = (0.25, 2.5)  # of the mean curvature: the skull does not shrink away, ears do not outgrow the head


class Exaggeration:
    """Exaggerates the heads of one template (paper 4.1, after Sela, Aflalo and Kimmel 2015).

    The gradients of a head are multiplied by a power of its Gaussian curvature, relative to their mean, and the head
    whose gradients are nearest to them in least squares (Poisson reconstruction) is its caricature. Eyes, mouth and the
    rim of the neck are held fixed. All expressions of an identity are scaled by the curvature of its resting head: one
    character in all of them.

    Parameters
    ----------
    template : Template
    rest : (n, 3) array
        Coarse vertices of a typical head at rest, millimetres: tells what lies about its eyes and its mouth.
    """

    def __init__(self, template: Template, rest: np.ndarray) -> None:
        self._moving, self._faces = template.soft
        still = [name for name in (*FEATURES, *LIPS) if any(part in name for part in ("eye", "mouth", "lip"))]
        fine = template.subdivision @ rest
        about = KDTree(fine[np.concatenate([template.curves[name] for name in still])])
        self._held = about.query(rest[self._moving])[0] < _HELD_MM
        self._held |= template.parts[self._moving] == PARTS.index("mouth")
        self._rim = np.unique(igl.boundary_facets(self._faces)[0])
        self._held[self._rim] = True
        neighbours = igl.adjacency_matrix(self._faces).astype(np.float64)
        piece = connected_components(neighbours, directed=False)[1]
        self._held |= ~np.isin(piece, piece[self._held])  # nothing would keep a loose piece in its place
        self._average = neighbours.multiply(1 / np.maximum(neighbours.sum(axis=1), 1)).tocsr()

    def scales(self, rest: np.ndarray) -> np.ndarray:
        """How much each level scales the gradients in each triangle of a resting head (n, 3): (levels, triangles)."""
        vertices = np.asarray(rest, dtype=np.float64)[self._moving]
        area = igl.massmatrix(vertices, self._faces).diagonal()
        curvature = np.abs(np.ravel(igl.gaussian_curvature(vertices, self._faces))) / area
        curvature[self._rim] = 0.0  # a border has no Gaussian curvature
        curvature = np.minimum(curvature, np.percentile(curvature, _SHARPEST))
        for _ in range(_ROUNDS):
            curvature = 0.5 * (curvature + self._average @ curvature)
        relative = np.clip(curvature / np.average(curvature, weights=area), *_BOUNDS)
        scales = np.stack([(relative**power)[self._faces].mean(axis=1) for power in POWERS])
        return scales / np.average(scales, axis=1, weights=np.asarray(igl.doublearea(vertices, self._faces)))[:, None]

    def __call__(self, rest: np.ndarray, heads: np.ndarray) -> np.ndarray:
        """Heads of one identity at every level.

        Parameters
        ----------
        rest : (n, 3) array
            Coarse vertices of the identity at rest.
        heads : (e, n, 3) array
            The identity in some expressions.

        Returns
        -------
        (levels, e, n, 3) float32 array
            The first level is `heads`; eyes, teeth and tongue stay where they are in all.
        """
        gradients = self.scales(rest)[1:, :, None, None] * np.eye(3)
        exaggerated = np.repeat(np.asarray(heads, dtype=np.float32)[None], LEVELS, axis=0)
        for number, head in enumerate(heads):
            reconstruct = DeformationTransfer(head[self._moving], self._faces, self._held)
            exaggerated[1:, number, self._moving] = reconstruct(gradients)
        return exaggerated
