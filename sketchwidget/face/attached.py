"""The parts of a head that do not deform, eyes, teeth and tongue, and how they follow the skin."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import igl
import numpy as np
from scipy import sparse
from scipy.interpolate import LinearNDInterpolator
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from ..geometry.smoothstep import smoothstep
from .template import PARTS, Template

_FACING = 0.2  # z of a normal
_RIGID = 0.6  # of the radius of an eyeball, within which it keeps its form
_COVERING = 4  # vertices of the skin before a vertex of its rim
_RESHAPED = 0.3  # mm by which lids are drawn into another form
_ROOM = 0.9  # mm between an eyeball and the lids before it; at rest there are 1.2


@dataclass(frozen=True)
class Attached:
    """A part of its own, which goes with the skin by a shift, and gets narrower if that does.

    Parameters
    ----------
    vertices : (p,) array
    leaders : (l,) array
        The vertices of the skin that it follows.
    """

    vertices: np.ndarray
    leaders: np.ndarray

    is_eye: ClassVar[bool] = False

    def follow(self, before: np.ndarray, after: np.ndarray) -> None:
        """Go where the skin of a head (V, 3) went in x and y, in ``after``."""
        start, end, turn = _similarity(before[self.leaders], after[self.leaders])
        here = _in_plane(before[self.vertices]) - start
        _place(after, self.vertices, end + min(1.0, turn.real) * here.real + 1j * here.imag)


@dataclass(frozen=True)
class Eyeball(Attached):
    """An eyeball, which goes by the similarity of the front view that takes the corners of its lids along.

    Its rim goes the way of the skin before it, behind which it stays so; and where lids that are drawn into another
    form would pass through it, it goes to the back.

    Parameters
    ----------
    rim, rim_skin, rim_shares : (r,), (r, c), (r, c) arrays
        Vertices of the rim, those of the skin before each, and the shares of its way that it takes from them.
    contours : (e,) array
        Vertices of the edges of its lids.
    lids : (t, 3) array
        Triangles of the skin about it.
    """

    rim: np.ndarray
    rim_skin: np.ndarray
    rim_shares: np.ndarray
    contours: np.ndarray
    lids: np.ndarray

    is_eye: ClassVar[bool] = True

    def follow(self, before: np.ndarray, after: np.ndarray) -> None:
        """Go where the lids of a head (V, 3) went in x and y, in ``after``."""
        start, end, turn = _similarity(before[self.leaders], after[self.leaders])
        _place(after, self.vertices, end + turn * (_in_plane(before[self.vertices]) - start))
        shares, rigid = self.rim_shares, 1 - self.rim_shares.sum(axis=1)
        way, of_skin = (_in_plane(after[at]) - _in_plane(before[at]) for at in (self.rim, self.rim_skin))
        _place(after, self.rim, _in_plane(before[self.rim]) + rigid * way + (shares * of_skin).sum(axis=1))
        expected = end + turn * (_in_plane(before[self.contours]) - start)
        if np.abs(_in_plane(after[self.contours]) - expected).max() > _RESHAPED:
            pierced = self._in_the_way(after)
            if pierced > 0:
                after[self.vertices, 2] -= max(0.0, pierced - max(0.0, self._in_the_way(before)))

    @cached_property
    def _corners(self) -> np.ndarray:
        """Vertices of the skin about it."""
        return np.unique(self.lids)

    def _in_the_way(self, mesh: np.ndarray) -> float:
        """Millimetres that it is further to the front than the lids of a head allow."""
        eye = mesh[self.vertices]
        front = eye[eye[:, 2] > eye[:, 2].mean()]
        skin = np.concatenate([mesh[self._corners], sum(mesh[corner] for corner in self.lids.T) / 3])
        height = LinearNDInterpolator(front[:, :2], front[:, 2])(skin[:, :2])
        return float(np.nanmax(height - skin[:, 2] + _ROOM, initial=-np.inf))


def attached_parts(template: Template, rest: np.ndarray) -> list[Attached]:
    """The parts that do not deform, in a typical head at rest (V, 3)."""
    faces = template.faces
    ends = (faces.ravel(), np.roll(faces, 1, axis=1).ravel())
    links = sparse.coo_matrix((np.ones(faces.size, dtype=bool), ends), shape=(len(rest), len(rest)))
    label = connected_components(links, directed=False)[1]
    front = in_front(template.faces, rest, template.fine_parts)
    tree, numbers = KDTree(rest[front, :2]), np.flatnonzero(front)
    parts = []
    for number in np.unique(label[template.fine_parts > PARTS.index("mouth")]):
        part = np.flatnonzero(label == number)
        if template.fine_parts[part[0]] == PARTS.index("eyes"):
            parts.append(_eyeball(part, template, rest, front))
        else:
            parts.append(Attached(part, numbers[tree.query(rest[part, :2])[1]]))
    return parts


def in_front(faces: np.ndarray, points: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Which vertices (n,) bool are skin that faces the front."""
    normals = np.asarray(igl.per_vertex_normals(points.astype(np.float64), faces.astype(np.int64)))
    return (parts == PARTS.index("skin")) & (normals[:, 2] > _FACING)


def _eyeball(vertices: np.ndarray, template: Template, rest: np.ndarray, front: np.ndarray) -> Eyeball:
    """An eyeball of a typical head at rest, whose skin (V,) bool faces the front."""
    middle = rest[vertices].mean(axis=0)
    off = np.linalg.norm((rest - middle)[:, :2], axis=1)
    radius = off[vertices].max()
    rim = vertices[off[vertices] > _RIGID * radius]
    before = np.flatnonzero(front)
    away, nearest = KDTree(rest[before, :2]).query(rest[rim, :2], k=_COVERING)
    weights = 1 / (away + 0.1)
    weights *= (smoothstep(off[rim] / radius, _RIGID) / weights.sum(axis=1))[:, None]
    near = front & (off < 1.2 * radius)
    lids = template.faces[near[template.faces].all(axis=1)]
    side = "left" if middle[0] > 0 else "right"
    upper, lower = (template.curves[f"{side}_eye_{lid}"] for lid in ("upper", "lower"))
    contours = np.concatenate([upper, lower])
    return Eyeball(vertices, upper[[0, -1]], rim, before[nearest], weights, contours, lids)


def _similarity(before: np.ndarray, after: np.ndarray) -> tuple[complex, complex, complex]:
    """Middles before and after, and the turn and growth between, of the similarity of the plane nearest to a motion."""
    start, end = _in_plane(before), _in_plane(after)
    spread = start - start.mean()
    return start.mean(), end.mean(), (end * spread.conj()).sum() / (np.abs(spread) ** 2).sum()


def _in_plane(points: np.ndarray) -> np.ndarray:
    return points[..., 0] + 1j * points[..., 1]


def _place(mesh: np.ndarray, vertices: np.ndarray, there: np.ndarray) -> None:
    mesh[vertices, :2] = np.stack([np.real(there), np.imag(there)], axis=1)
