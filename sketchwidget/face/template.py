"""What all faces share: topology, parts, curves and landmarks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from ..geometry.subdivision import catmull_clark

PARTS = ("skin", "mouth", "eyes", "teeth", "tongue")


@dataclass(frozen=True)
class Template:
    """The topology of a family of registered heads, held coarse and refined by one Catmull-Clark step.

    Parameters
    ----------
    quads : (m, 4) int array
        Faces of the coarse mesh.
    parts : (n,) uint8 array
        For each coarse vertex the index in `PARTS` of what it belongs to.
    curves : dict of (k,) int arrays
        Fine vertex sequences by line name: the curve handles of DeepSketch2Face, Figure 3 (b). A closed curve ends
        where it starts.
    landmarks : (68,) int array
        Fine vertices in iBUG order (the subject's right jaw first).
    """

    quads: np.ndarray
    parts: np.ndarray
    curves: dict[str, np.ndarray]
    landmarks: np.ndarray

    def __post_init__(self) -> None:
        if self.landmarks.shape != (68,):
            raise ValueError(f"a template has 68 landmarks; given an array of shape {self.landmarks.shape}")

    @property
    def coarse_count(self) -> int:
        """Number of coarse vertices."""
        return len(self.parts)

    @cached_property
    def _refined(self) -> tuple[sparse.csr_matrix, np.ndarray, np.ndarray]:
        return catmull_clark(self.quads, self.coarse_count)

    @property
    def subdivision(self) -> sparse.csr_matrix:
        """Fine vertices (V) from coarse ones (n), as a sparse (V, n) matrix."""
        return self._refined[0]

    @cached_property
    def faces(self) -> np.ndarray:
        """Triangles of the fine mesh, (F, 3) int32."""
        quads = self._refined[1]
        return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])

    @cached_property
    def coarse_faces(self) -> np.ndarray:
        """Triangles of the coarse mesh, (2 m, 3) int32."""
        return np.concatenate([self.quads[:, [0, 1, 2]], self.quads[:, [0, 2, 3]]]).astype(np.int32)

    @cached_property
    def fine_parts(self) -> np.ndarray:
        """Index in `PARTS` of each fine vertex, (V,) uint8; where parts meet, the lower index."""
        edges = self._refined[2]
        return np.concatenate([self.parts, self.parts[edges].min(axis=1), self.parts[self.quads].min(axis=1)])
