"""The inside of the mouth keeps behind the skin that covers it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.visibility import covering
from .template import PARTS, Template

_ABOUT = 10.0  # mm about the inside of the mouth, within which skin may cover it
_ROOM = 2.0  # mm to the skin that is left, unless it was nearer before
_MOVED = 1.0  # mm: where all of it moves more evenly than that, nothing comes out


@dataclass(frozen=True, eq=False)
class Covered:
    """Vertices, and the skin that may cover them.

    Parameters
    ----------
    vertices : (k,) int array
    skin : (s,) int array
        Vertices of the skin.
    triangles : (t, 3) int array
        Of these.
    """

    vertices: np.ndarray
    skin: np.ndarray
    triangles: np.ndarray

    @classmethod
    def by(cls, faces: np.ndarray, vertices: np.ndarray) -> Covered:
        """Vertices covered by some triangles (t, 3) of the head."""
        skin, numbers = np.unique(faces, return_inverse=True)
        return cls(vertices, skin, numbers.reshape(-1, 3))

    def room(self, head: np.ndarray) -> np.ndarray:
        """How far (k,) they are behind the skin of a head (V, 3); minus infinity where it has none at their place."""
        which, above = covering(head[self.vertices], head[self.skin], self.triangles)
        room = np.full(len(self.vertices), -np.inf)
        np.maximum.at(room, which, above)
        return room

    def lacking(self, before: np.ndarray, after: np.ndarray) -> np.ndarray:
        """By how much (k,) they are less behind the skin than they were, or should be."""
        room = self.room(after)
        near = np.flatnonzero(np.isfinite(room) & (room < _ROOM))
        former = Covered(self.vertices[near], self.skin, self.triangles).room(before)
        lacking = np.zeros(len(room))
        lacking[near] = np.maximum(np.where(former < 0, _ROOM, np.minimum(former, _ROOM)) - room[near], 0.0)
        return lacking


@dataclass(frozen=True, eq=False)
class Lining:
    """The inside of a mouth, and the skin before it.

    Parameters
    ----------
    inside : Covered
    scouts : Covered
        The same on the coarse mesh: a quarter as many tell whether anything comes out.
    """

    inside: Covered
    scouts: Covered

    @classmethod
    def of(cls, template: Template, rest: np.ndarray) -> Lining:
        """That of a typical head at rest (V, 3)."""
        inside = np.flatnonzero(template.fine_parts == PARTS.index("mouth"))
        near = template.fine_parts == PARTS.index("skin")
        if len(inside):
            low, high = rest[inside, :2].min(axis=0) - _ABOUT, rest[inside, :2].max(axis=0) + _ABOUT
            near = near & ((rest[:, :2] > low) & (rest[:, :2] < high)).all(axis=1)
        skin, coarse = (faces[near[faces].all(axis=1)] for faces in (template.faces, template.coarse_faces))
        return cls(Covered.by(skin, inside), Covered.by(coarse, inside[inside < template.coarse_count]))

    def follow(self, before: np.ndarray, after: np.ndarray) -> None:
        """Go to the back where it would come out of the skin of a head (V, 3), in ``after``."""
        scouts = self.scouts.vertices
        if not len(scouts) or np.ptp(after[scouts] - before[scouts], axis=0).max() < _MOVED:
            return
        if self.scouts.lacking(before, after).any():
            after[self.inside.vertices, 2] -= self.inside.lacking(before, after)
