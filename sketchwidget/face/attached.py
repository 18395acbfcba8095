"""The parts of a head that do not deform, eyes, teeth and tongue, and how they follow the skin."""

from __future__ import annotations

from dataclasses import dataclass

import igl
import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from .template import PARTS, Template

_FACING = 0.2  # z of a normal
_RIGID = 0.6  # of the radius of an eyeball, within which it keeps its form
_COVERING = 4  # vertices of the skin before a vertex of its rim


@dataclass(frozen=True)
class Rim:
    """The rim of an eyeball, which lids and temple hide.

    Parameters
    ----------
    vertices : (r,) array
    skin : (r, c) array
        Vertices of the skin before each.
    shares : (r, c) array
        Of its way that it takes from them; what is missing to 1, from its eyeball.
    """

    vertices: np.ndarray
    skin: np.ndarray
    shares: np.ndarray

    def follow(self, before: np.ndarray, after: np.ndarray) -> None:
        """In the front view, what goes the way of the skin before it stays behind it."""
        ways = (after - before)[self.skin][..., :2]
        kept = 1 - self.shares.sum(axis=1, keepdims=True)
        rigid = kept * (after - before)[self.vertices, :2]
        after[self.vertices, :2] = before[self.vertices, :2] + rigid + np.einsum("rc,rck->rk", self.shares, ways)


@dataclass(frozen=True)
class Attached:
    """A part of its own, and the vertices of the skin that it follows.

    Teeth and tongue go with the skin by a shift, and get narrower if it does; an eyeball by the similarity of the front
    view that takes the corners of its lids along, but for its rim.
    """

    vertices: np.ndarray
    leaders: np.ndarray
    rim: Rim | None = None

    @property
    def is_eye(self) -> bool:
        """Whether it is an eyeball."""
        return self.rim is not None

    def follow(self, before: np.ndarray, after: np.ndarray) -> None:
        """Go where the skin of a head (V, 3) went in x and y, in ``after``."""
        start, end = (mesh[self.leaders, 0] + 1j * mesh[self.leaders, 1] for mesh in (before, after))
        spread = start - start.mean()
        turn = (end * spread.conj()).sum() / (np.abs(spread) ** 2).sum()
        here = before[self.vertices, 0] + 1j * before[self.vertices, 1] - start.mean()
        there = end.mean() + (turn * here if self.is_eye else min(1.0, turn.real) * here.real + 1j * here.imag)
        after[self.vertices, 0], after[self.vertices, 1] = there.real, there.imag
        if self.rim is not None:
            self.rim.follow(before, after)


def attached_parts(template: Template, rest: np.ndarray) -> list[Attached]:
    """The parts that do not deform, in a typical head at rest (V, 3)."""
    faces = template.faces
    ends = (faces.ravel(), np.roll(faces, 1, axis=1).ravel())
    links = sparse.coo_matrix((np.ones(faces.size, dtype=bool), ends), shape=(len(rest), len(rest)))
    label = connected_components(links, directed=False)[1]
    front = np.flatnonzero(in_front(template.faces, rest, template.fine_parts))
    tree = KDTree(rest[front, :2])
    parts = []
    for number in np.unique(label[template.fine_parts > PARTS.index("mouth")]):
        part = np.flatnonzero(label == number)
        if template.fine_parts[part[0]] == PARTS.index("eyes"):
            side = "left" if rest[part, 0].mean() > 0 else "right"
            corners = template.curves[f"{side}_eye_upper"][[0, -1]]
            parts.append(Attached(part, corners, _rim(part, rest, front)))
        else:
            parts.append(Attached(part, front[tree.query(rest[part, :2])[1]]))
    return parts


def in_front(faces: np.ndarray, points: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Which vertices (n,) bool are skin that faces the front."""
    normals = np.asarray(igl.per_vertex_normals(points.astype(np.float64), faces.astype(np.int64)))
    return (parts == PARTS.index("skin")) & (normals[:, 2] > _FACING)


def _rim(eye: np.ndarray, rest: np.ndarray, front: np.ndarray) -> Rim:
    """Of an eyeball, with the nearest of the skin that faces the front."""
    off = np.linalg.norm((rest[eye] - rest[eye].mean(axis=0))[:, :2], axis=1)
    share = np.clip((off / off.max() - _RIGID) / (1 - _RIGID), 0.0, 1.0)
    rim = share > 0
    away, nearest = KDTree(rest[front, :2]).query(rest[eye[rim], :2], k=_COVERING)
    weights = 1 / (away + 0.1)
    share = share[rim] ** 2 * (3 - 2 * share[rim])
    return Rim(eye[rim], front[nearest], share[:, None] * weights / weights.sum(axis=1, keepdims=True))
