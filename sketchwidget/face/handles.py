"""The curve handles of a face model: dragging its lines deforms the head (DeepSketch2Face 5.1)."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components, dijkstra

from ..geometry.handle_deformation import HandleDeformation
from ..sketch import FEATURES, SILHOUETTE
from .template import PARTS, Template

LINES = (SILHOUETTE, *FEATURES)

_SOFTNESS = 1e-2  # mm^2 of the energy: a drawn line is met within tenths of a millimetre, not every tremor in it
_ANCHOR = 100.0**-4  # 1 / mm^4: the back of the head stays
# Landmarks on the middle of the face from the root of the nose down: the profile runs through them.
_UPPER, _LOWER = (27, 28, 29, 30, 33, 51, 62), (66, 57, 8)
_OFF_MIDDLE = 1.0  # mm off the middle that make a way twice as long
_DEPTH_KEPT = ("silhouette", "ear", "eye")  # lines, by a part of their name, that stay in depth when the profile moves
_AT_A_LINE = 6.0  # mm from a line of the front view, within which that gives the profile its height


class CurveHandles:
    """Deforms heads of one topology by their lines.

    Skin and mouth deform smoothly, by a displacement of the coarse mesh that is refined as the mesh itself. An eyeball
    follows the corners of its lids by a similarity of the front view; teeth and tongue follow those of the mouth by a
    shift.

    Parameters
    ----------
    template : Template
    rest : (V, 3) array
        A typical head at rest, millimetres.

    Attributes
    ----------
    profile : (k,) int32 array
        The vertices of the profile, which is drawn in side views.
    """

    def __init__(self, template: Template, rest: np.ndarray) -> None:
        self._template, self._rest = template, np.asarray(rest)
        self._paths = {name: template.curves[name] for name in LINES}
        self.profile = profile_curve(template, rest)
        self._refine = template.subdivision[:, template.soft[0]]
        self._front = self._deformation(np.concatenate(list(self._paths.values())))
        self._parts = _parts(template, rest)

    def __call__(
        self, vertices: np.ndarray, targets: Mapping[str, np.ndarray], profile: np.ndarray | None = None
    ) -> np.ndarray:
        """A head whose lines are where they were drawn.

        Parameters
        ----------
        vertices : (V, 3) array
            The head before.
        targets : mapping of (k, 2) arrays
            For some lines, x and y in millimetres where their handle points go; a point that is not finite is free.
            Depth stays.
        profile : (p, 2) array, optional
            z and y in millimetres where the points of the profile go; those that are not finite are free.

        Returns
        -------
        (V, 3) float32 array
        """
        moves = np.full((sum(map(len, self._paths.values())), 2), np.nan)
        start = 0
        for name, path in self._paths.items():
            if name in targets:
                moves[start : start + len(path)] = targets[name] - vertices[path, :2]
            start += len(path)
        moved = np.array(vertices, dtype=np.float32)
        if profile is None:
            moved[:, :2] += self._refine @ self._front(moves)
        else:
            moved += self._refine @ self._with_profile(moves, profile - vertices[self.profile][:, [2, 1]])
        self._follow(vertices, moved)
        return moved

    def _with_profile(self, moves: np.ndarray, profile: np.ndarray) -> np.ndarray:
        """Displacements (s, 3) for those of the front view's handles (h, 2) and of the profile (p, 2) in z and y."""
        count = len(moves)
        wanted = np.full((count + len(profile), 3), np.nan)
        wanted[:count, :2] = moves
        wanted[count:, 1] = np.where(self._height_given, np.nan, profile[:, 1])
        wanted[count:, 2] = profile[:, 0]
        start = 0
        for name, path in self._paths.items():
            if any(part in name for part in _DEPTH_KEPT):
                wanted[start : start + len(path), 2] = 0.0
            start += len(path)
        return np.concatenate([self._side(wanted[:, [axis]]) for axis in range(3)], axis=1)

    @cached_property
    def _side(self) -> HandleDeformation:
        """With the profile as a further handle."""
        return self._deformation(np.concatenate([*self._paths.values(), self.profile]))

    @cached_property
    def _height_given(self) -> np.ndarray:
        lines = self._rest[np.concatenate(list(self._paths.values()))]
        return np.linalg.norm(self._rest[self.profile][:, None] - lines[None], axis=2).min(axis=1) < _AT_A_LINE

    def _deformation(self, handles: np.ndarray) -> HandleDeformation:
        soft, faces = self._template.soft
        # The coarse mesh at rest: the vertices of a Catmull-Clark step that came of its own vertices are the first.
        coarse = self._rest[: self._template.coarse_count][soft]
        return HandleDeformation(coarse, faces, self._refine[handles], _SOFTNESS, _ANCHOR)

    def _follow(self, vertices: np.ndarray, moved: np.ndarray) -> None:
        """Parts of their own go where the corners of lids or mouth went."""
        for part, corners, grows in self._parts:
            before, after = (mesh[corners, 0] + 1j * mesh[corners, 1] for mesh in (vertices, moved))
            turn = (after[1] - after[0]) / (before[1] - before[0]) if grows else 1.0
            here = vertices[part, 0] + 1j * vertices[part, 1]
            there = after.mean() + turn * (here - before.mean())
            moved[part, 0], moved[part, 1] = there.real, there.imag


def profile_curve(template: Template, rest: np.ndarray) -> np.ndarray:
    """The profile: vertices (k,) int32 down the middle of the face, from the top of the silhouette to the chin.

    No line of the mesh is predefined there; this one runs along edges through the landmarks of the middle. At the mouth
    it leaps from lip to lip.
    """
    skin = template.fine_parts == PARTS.index("skin")
    corners = template.faces
    edges = np.unique(np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    edges = edges[skin[edges].all(axis=1)]
    length = np.linalg.norm(rest[edges[:, 0]] - rest[edges[:, 1]], axis=1)
    off = np.abs(rest[edges, 0]).max(axis=1) / _OFF_MIDDLE
    graph = sparse.coo_matrix((length * (1 + off**2), edges.T), shape=(len(rest), len(rest))).tocsr()
    silhouette = template.curves[SILHOUETTE]
    top = silhouette[np.argmax(rest[silhouette, 1])]
    upper, lower = (top, *template.landmarks[list(_UPPER)]), tuple(template.landmarks[list(_LOWER)])
    return np.concatenate([_way(graph, upper), _way(graph, lower)]).astype(np.int32)


def _way(graph: sparse.csr_matrix, stations: tuple[int, ...]) -> list[int]:
    """The vertices of the shortest way through some of them."""
    way = [int(stations[0])]
    for start, end in pairwise(stations):
        before = dijkstra(graph, directed=False, indices=int(start), return_predecessors=True)[1]
        back = [int(end)]
        while back[-1] != start:
            if before[back[-1]] < 0:
                raise ValueError("the landmarks of the middle of the face are not connected by skin")
            back.append(int(before[back[-1]]))
        way += back[-2::-1]
    return way


def _parts(template: Template, rest: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, bool]]:
    """Each part of its own: its vertices, the two corners (2,) that it follows, and whether it grows with them."""
    faces = template.faces
    ends = (faces.ravel(), np.roll(faces, 1, axis=1).ravel())
    links = sparse.coo_matrix((np.ones(faces.size, dtype=bool), ends), shape=(len(rest), len(rest)))
    label = connected_components(links, directed=False)[1]
    parts = []
    for number in np.unique(label[template.fine_parts > PARTS.index("mouth")]):
        part = np.flatnonzero(label == number)
        eye = bool(template.fine_parts[part[0]] == PARTS.index("eyes"))
        side = "left" if rest[part, 0].mean() > 0 else "right"
        line = template.curves[f"{side}_eye_upper" if eye else "mouth_upper"]
        parts.append((part, line[[0, -1]], eye))
    return parts
