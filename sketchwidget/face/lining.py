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
class Lining:
    """The inside of a mouth, and the skin before it.

    Parameters
    ----------
    vertices : (k,) int array
        Of the inside of the mouth.
    skin : (t, 3) int array
        Triangles that may cover it.
    scouts, scouted : (c,) and (s, 3) int arrays
        The same on the coarse mesh: a quarter as many tell whether anything comes out.
    """

    vertices: np.ndarray
    skin: np.ndarray
    scouts: np.ndarray
    scouted: np.ndarray

    @classmethod
    def of(cls, template: Template, rest: np.ndarray) -> Lining:
        """That of a typical head at rest (V, 3)."""
        inside = np.flatnonzero(template.fine_parts == PARTS.index("mouth"))
        near = template.fine_parts == PARTS.index("skin")
        if len(inside):
            low, high = rest[inside, :2].min(axis=0) - _ABOUT, rest[inside, :2].max(axis=0) + _ABOUT
            near = near & ((rest[:, :2] > low) & (rest[:, :2] < high)).all(axis=1)
        skin, scouted = (faces[near[faces].all(axis=1)] for faces in (template.faces, template.coarse_faces))
        return cls(inside, skin, inside[inside < template.coarse_count], scouted)

    def follow(self, before: np.ndarray, after: np.ndarray) -> None:
        """Go to the back where it would come out of the skin of a head (V, 3), in ``after``."""
        moved = after[self.scouts] - before[self.scouts]
        if not len(moved) or np.ptp(moved, axis=0).max() < _MOVED:
            return
        if _lacking(self.scouts, self.scouted, before, after).any():
            after[self.vertices, 2] -= _lacking(self.vertices, self.skin, before, after)


def _lacking(vertices: np.ndarray, skin: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """By how much (k,) vertices of a head are less behind its skin than they were, or should be."""
    room = _room(vertices, skin, after)
    near = np.flatnonzero(np.isfinite(room) & (room < _ROOM))
    former = _room(vertices[near], skin, before)
    lacking = np.zeros(len(vertices))
    lacking[near] = np.maximum(np.where(former < 0, _ROOM, np.minimum(former, _ROOM)) - room[near], 0.0)
    return lacking


def _room(vertices: np.ndarray, skin: np.ndarray, head: np.ndarray) -> np.ndarray:
    """How far (k,) vertices of a head are behind its skin; minus infinity where it has none at that place."""
    which, above = covering(head[vertices], head, skin)
    room = np.full(len(vertices), -np.inf)
    np.maximum.at(room, which, above)
    return room
