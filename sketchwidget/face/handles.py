"""The curve handles of a face model: dragging its lines deforms the head (DeepSketch2Face 5.1)."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Literal

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import KDTree

from ..geometry.edges import edges
from ..geometry.handle_deformation import HandleDeformation
from ..geometry.unfolding import Unfolding
from ..sketch import FEATURES, SILHOUETTE
from .attached import attached_parts, in_front
from .lining import Lining
from .template import PARTS, Template

LINES = (SILHOUETTE, *FEATURES)
Way = Literal["linear", "turning", "unfolded"]

_SOFTNESS = 1e-2  # mm^2 of the energy: a drawn line is met within tenths of a millimetre, not every tremor in it
_GIVING_WAY = 6e-4  # mm^2: the same, where the skin is unfolded
_ANCHOR = 100.0**-4  # 1 / mm^4: the back of the head stays
# Landmarks on the middle of the face from the root of the nose down: the profile runs through them.
_UPPER, _LOWER = (27, 28, 29, 30, 33, 51, 62), (66, 57, 8)
_OFF_MIDDLE = 1.0  # mm off the middle that make a way twice as long
_DEPTH_KEPT = ("silhouette", "ear", "eye")  # lines, by a part of their name, that stay in depth when the profile moves
_HANGING = 4.0  # mm from the lips within which the inside of the mouth goes with them
_COVERING, _BLUR = 12, 5.0  # vertices of the skin in front, and mm by which their displacements are blurred
_AT_A_LINE = 6.0  # mm from a line of the front view, within which that gives the profile its height


class CurveHandles:
    """Deforms heads of one topology by their lines.

    Skin deforms smoothly, by a displacement of the coarse mesh that is refined as the mesh itself; where that would
    fold it, it gives way until it does not. What is behind it keeps behind it: the inside of the mouth goes with the
    lips where it hangs on them, and deeper with the skin before it, further back as `Lining` says; eyes, teeth and
    tongue follow, as `Attached` says.

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
        # A Catmull-Clark step puts the vertices of the coarse mesh first.
        self._coarse = self._rest[: template.coarse_count]
        self._refine = template.subdivision[:, template.soft[0]]
        self._spread = self._refine @ _covered(template, self._coarse)
        front = np.concatenate(list(self._paths.values()))
        soft, faces = template.soft
        self._deformation = HandleDeformation(
            self._coarse[soft],
            faces,
            self._refine[np.concatenate([front, self.profile])],
            _SOFTNESS,
            _ANCHOR,
            usual=np.arange(len(front) + len(self.profile)) < len(front),
        )
        self._unfolding = Unfolding(
            self._coarse[soft],
            _of_skin(faces, template.parts[soft]),
            self._spread,
            _of_skin(template.faces, template.fine_parts),
            self._deformation.handles,
            _GIVING_WAY,
        )
        away = np.linalg.norm(self._rest[self.profile][:, None] - self._rest[front], axis=2).min(axis=1)
        self._height_given = away < _AT_A_LINE
        self._lining = Lining.of(template, rest)
        self._parts = attached_parts(template, rest)

    def __call__(
        self,
        vertices: np.ndarray,
        targets: Mapping[str, np.ndarray],
        profile: np.ndarray | None = None,
        way: Way = "unfolded",
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
            Millimetres in depth and height by which the points of the profile go further than the lines alone would
            take them; those that are not finite are free.
        way : str
            "linear" keeps Laplacian coordinates and may fold; "turning" lets them turn and grow with what is around
            them in the front view, and may fold too, and takes no profile along; "unfolded" is linear but where it
            would fold. The last is what follow-up sketching does, the others are there to compare.

        Returns
        -------
        (V, 3) float32 array
        """
        moves = self._moves(vertices, targets)
        moved = np.array(vertices, dtype=np.float32)
        across = moves[:, :2]
        held = np.asarray(np.isfinite(across).all(axis=1))
        if way == "turning":
            soft = moved[: self._template.coarse_count][self._template.soft[0]]
            displaced = self._deformation.turning(soft, across)
        else:
            displaced = self._deformation(across)
        if profile is not None:
            depth, rise = self._dragged(moves[:, 2], profile)
            displaced[:, 1] += self._deformation(rise[:, None])[:, 0]
            held = held | np.isfinite(rise)
            moved[:, 2] += self._spread @ self._deformation(depth[:, None])[:, 0]
        moved[:, :2] += self._unfolding(vertices, displaced, held) if way == "unfolded" else self._spread @ displaced
        self._lining.follow(vertices, moved)
        for part in self._parts:
            part.follow(vertices, moved)
        return moved

    def _moves(self, vertices: np.ndarray, targets: Mapping[str, np.ndarray]) -> np.ndarray:
        """Displacements (h, 3) of the handles in the front view, and none in depth of what the profile leaves alone."""
        moves = np.full((sum(map(len, self._paths.values())) + len(self.profile), 3), np.nan)
        start = 0
        for name, path in self._paths.items():
            rows = slice(start, start + len(path))
            if name in targets:
                moves[rows, :2] = targets[name] - vertices[path, :2]
            if any(part in name for part in _DEPTH_KEPT):
                moves[rows, 2] = 0.0
            start += len(path)
        return moves

    def _dragged(self, depth: np.ndarray, profile: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacements (h,) of the handles in depth, and in height beyond that of the lines, which keep theirs."""
        depth, rise = depth.copy(), np.zeros(len(depth))
        depth[-len(profile) :] = profile[:, 0]
        rise[-len(profile) :] = np.where(self._height_given, np.nan, profile[:, 1])
        return depth, rise


def profile_curve(template: Template, rest: np.ndarray) -> np.ndarray:
    """The profile: vertices (k,) int32 down the middle of the face, from the top of the silhouette to the chin.

    No line of the mesh is predefined there; this one runs along edges through the landmarks of the middle. At the mouth
    it leaps from lip to lip.
    """
    skin = template.fine_parts == PARTS.index("skin")
    between = edges(template.faces)
    between = between[skin[between].all(axis=1)]
    length = np.linalg.norm(rest[between[:, 0]] - rest[between[:, 1]], axis=1)
    off = np.abs(rest[between, 0]).max(axis=1) / _OFF_MIDDLE
    graph = sparse.csr_matrix((length * (1 + off**2), between.T), shape=(len(rest), len(rest)))
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


def _covered(template: Template, coarse: np.ndarray) -> sparse.csr_matrix:
    """Displacements of skin and mouth (s, s) with those of the inside of the mouth made to go with what covers it."""
    soft, faces = template.soft
    parts = template.parts[soft]
    skin = parts == PARTS.index("skin")
    if skin.all():
        return sparse.csr_matrix(sparse.identity(len(soft)))
    points = coarse[soft]
    inside = np.flatnonzero(~skin)
    edges = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    seam = edges[skin[edges[:, 0]] & ~skin[edges[:, 1]], 0]
    away, hook = KDTree(points[seam]).query(points[inside])
    hangs = np.exp(-((away / _HANGING) ** 2))
    front = np.flatnonzero(in_front(faces, points, parts))
    distance, nearest = KDTree(points[front, :2]).query(points[inside, :2], k=_COVERING)
    weight = np.exp(-0.5 * ((distance - distance[:, :1]) / _BLUR) ** 2)
    weight *= ((1 - hangs) / weight.sum(axis=1))[:, None]
    rows = np.concatenate([np.flatnonzero(skin), inside, np.repeat(inside, _COVERING)])
    columns = np.concatenate([np.flatnonzero(skin), seam[hook], front[nearest].ravel()])
    values = np.concatenate([np.ones(skin.sum()), hangs, weight.ravel()])
    return sparse.csr_matrix((values, (rows, columns)), shape=(len(soft), len(soft)), dtype=np.float32)


def _of_skin(triangles: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Those of some triangles (k, 3) whose vertices, of these parts, are all skin."""
    return triangles[(parts[triangles] == PARTS.index("skin")).all(axis=1)]
