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
        Faces of the coarse mesh. A triangle repeats its third corner; only a mesh that is not refined may have some.
    parts : (n,) uint8 array
        For each coarse vertex the index in `PARTS` of what it belongs to.
    curves : dict of (k,) int arrays
        Fine vertex sequences by line name: the curve handles of DeepSketch2Face, Figure 3 (b). A closed curve ends
        where it starts.
    landmarks : (68,) int array
        Fine vertices in iBUG order (the subject's right jaw first).
    refined : bool
        If False, the mesh is fine enough as it is: its coarse and its fine vertices are the same.

    Raises
    ------
    ValueError
        If there are not 68 landmarks, or a mesh with triangles is to be refined.
    """

    quads: np.ndarray
    parts: np.ndarray
    curves: dict[str, np.ndarray]
    landmarks: np.ndarray
    refined: bool = True

    def __post_init__(self) -> None:
        if self.landmarks.shape != (68,):
            raise ValueError(f"a template has 68 landmarks; given an array of shape {self.landmarks.shape}")
        if self.refined and (triangles := int((self.quads[:, 2] == self.quads[:, 3]).sum())):
            raise ValueError(f"only a mesh of quads is refined; given one with {triangles} triangles")

    @property
    def coarse_count(self) -> int:
        """Number of coarse vertices."""
        return len(self.parts)

    @cached_property
    def _fine(self) -> tuple[sparse.csr_matrix, np.ndarray, np.ndarray]:
        return catmull_clark(self.quads, self.coarse_count)

    @cached_property
    def subdivision(self) -> sparse.csr_matrix:
        """Fine vertices (V) from coarse ones (n), as a sparse (V, n) matrix: the identity if nothing is refined."""
        if not self.refined:
            return sparse.csr_matrix(sparse.identity(self.coarse_count), dtype=np.float32)
        return self._fine[0]

    @cached_property
    def faces(self) -> np.ndarray:
        """Triangles of the fine mesh, (F, 3) int32."""
        return _triangles(self._fine[1]) if self.refined else self.coarse_faces

    @cached_property
    def coarse_faces(self) -> np.ndarray:
        """Triangles of the coarse mesh, (f, 3) int32: two of each quad."""
        return _triangles(self.quads)

    @cached_property
    def soft(self) -> tuple[np.ndarray, np.ndarray]:
        """What deforms, skin and mouth: its coarse vertices (s,) and its triangles (t, 3), which number only these."""
        vertices = np.flatnonzero(self.parts <= PARTS.index("mouth"))
        number_of = np.full(self.coarse_count, -1)
        number_of[vertices] = np.arange(len(vertices))
        faces = number_of[self.coarse_faces]
        return vertices, faces[(faces >= 0).all(axis=1)]

    @cached_property
    def fine_parts(self) -> np.ndarray:
        """Index in `PARTS` of each fine vertex, (V,) uint8; where parts meet, the lower index."""
        if not self.refined:
            return self.parts
        edges = self._fine[2]
        return np.concatenate([self.parts, self.parts[edges].min(axis=1), self.parts[self.quads].min(axis=1)])


def _triangles(quads: np.ndarray) -> np.ndarray:
    """Two triangles of each quad, one where the third corner is repeated: (f, 3) int32."""
    second = quads[quads[:, 2] != quads[:, 3]]
    return np.concatenate([quads[:, [0, 1, 2]], second[:, [0, 2, 3]]]).astype(np.int32)
