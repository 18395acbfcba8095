"""Laplacian deformation of a part of a mesh by handles; the rest does not move (Sorkine et al. 2004)."""

from __future__ import annotations

from functools import cached_property

import igl
import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from .edges import edge_distance
from .smoothstep import smoothstep


class RegionDeformation:
    """Moves handles where they are wanted, and the rest of a region after them.

    The displacement `d` of the region is that with the least ``|L d|^2``, `L` the cotangent Laplacian: the change of
    the Laplacian coordinates of DeepSketch2Face's equation 2. Handles and all that lies outside are constraints, not
    penalties. As the energy counts the Laplacian of vertices outside too, the displacement leaves the border at slope
    0: no crease is seen there. One factorisation serves all edits of these handles.

    Parameters
    ----------
    vertices : (n, 3) array
        Whose shape the Laplacian is of; the mesh that is deformed may be another of the same topology.
    faces : (m, 3) int array
    region : (n,) bool array
        What may move.
    handles : (h,) int array
        Vertices within the region, each once.

    Raises
    ------
    ValueError
        If there are no handles, or some lie outside the region.
    """

    def __init__(self, vertices: np.ndarray, faces: np.ndarray, region: np.ndarray, handles: np.ndarray) -> None:
        region, self.handles = np.asarray(region, dtype=bool), np.asarray(handles, dtype=np.int64)
        if not len(self.handles):
            raise ValueError("a region is deformed by at least one handle; there are none")
        if not region[self.handles].all():
            count = int((~region[self.handles]).sum())
            raise ValueError(f"handles lie within the region; {count} of {len(self.handles)} lie outside")
        free = region.copy()
        free[self.handles] = False
        self._free = np.flatnonzero(free)
        self._count = len(region)
        self._vertices, self._faces, self._region = vertices, faces, region
        if len(self._free):
            energy = _bilaplacian(vertices, faces, region)
            rows = energy[self._free]
            self._pull = rows[:, self.handles]
            # The pattern is symmetric: this ordering and no pivoting halve the time.
            options = {"SymmetricMode": True}
            self._factor = splu(rows[:, self._free].tocsc(), "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)

    def displacement(self, of_handles: np.ndarray) -> np.ndarray:
        """Displacement (n, 3) of all vertices, from that of the handles (h, 3); 0 outside the region."""
        moved = np.zeros((self._count, 3))
        moved[self.handles] = of_handles
        if len(self._free):
            moved[self._free] = self._factor.solve(-(self._pull @ moved[self.handles]))
        return moved

    @cached_property
    def _depth(self) -> np.ndarray:
        """How far (n,) it is to the border, along the edges."""
        return edge_distance(self._vertices, self._faces, np.flatnonzero(~self._region))

    def fading(self, width: float, border: np.ndarray | None = None) -> np.ndarray:
        """Shares (h,) by which handles move, so that those at the border make no step: smoothly from 0 there to 1.

        Parameters
        ----------
        width : float
            Millimetres from the border at which it is 1; in a region that is less deep, it is 1 at its deepest.
        border : (b,) int array, optional
            The vertices that the border is made of; by default, all that lie outside.
        """
        depth = self._depth if border is None else edge_distance(self._vertices, self._faces, border)
        return smoothstep(depth[self.handles], 0.0, min(width, depth[self._region].max()))


def within_reach(vertices: np.ndarray, faces: np.ndarray, sources: np.ndarray, reach: float) -> np.ndarray:
    """Vertices not farther from any of `sources` than `reach`, in millimetres along the edges: (n,) bool."""
    return np.isfinite(edge_distance(vertices, faces, sources, reach))


def _bilaplacian(vertices: np.ndarray, faces: np.ndarray, region: np.ndarray) -> sparse.csr_matrix:
    """``L M^-1 L`` of the mesh, right in the rows of a region; `M` holds the area about each vertex."""
    faces = np.asarray(faces, dtype=np.int64)
    # A row of the product needs the Laplacian of the neighbours, and that needs the triangles about them.
    near = np.asarray(region, dtype=bool).copy()
    for _ in range(2):
        near[faces[near[faces].any(axis=1)]] = True
    kept, around = np.unique(faces[near[faces].any(axis=1)], return_inverse=True)
    around, points = around.reshape(-1, 3), np.asarray(vertices, dtype=np.float64)[kept]
    laplacian = igl.cotmatrix(points, around)
    area = igl.massmatrix(points, around, igl.MASSMATRIX_TYPE_BARYCENTRIC).diagonal()
    energy = (laplacian @ sparse.diags(1 / area) @ laplacian).tocoo()
    return sparse.csr_matrix((energy.data, (kept[energy.row], kept[energy.col])), (len(vertices), len(vertices)))
