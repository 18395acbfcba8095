"""Eyes, teeth and tongue keep behind the skin that covers them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from .attached import Attached
from .template import PARTS, Template

_APART = 0.08  # radians between a vertex of the skin and that of the part below, seen from its middle
_FARTHEST = 60.0  # mm from the middle of a part to the skin that covers it: beyond is the back of the head
_EYE_MM, _TEETH_MM = 0.15, 1.5  # of room that is left before an eyeball, and before all else
_ROUNDS = 60


@dataclass(frozen=True, eq=False)
class Cover:
    """The skin about a part that does not deform.

    Parameters
    ----------
    skin : (k,) int array
        Vertices of the skin.
    below : (k,) int array
        The vertex of the part that each covers.
    part : (p,) int array
        All vertices of the part.
    room : float
        Millimetres that the skin may not come nearer than, unless it is nearer already.
    """

    skin: np.ndarray
    below: np.ndarray
    part: np.ndarray
    room: float

    @classmethod
    def of(cls, attached: Attached, template: Template, rest: np.ndarray) -> Cover:
        """What covers a part in a typical head at rest (V, 3)."""
        part = attached.vertices
        middle = rest[part].mean(axis=0)
        skin = np.flatnonzero(template.fine_parts == PARTS.index("skin"))
        to_skin, to_part = (rest[vertices] - middle for vertices in (skin, part))
        away, depth = np.linalg.norm(to_skin, axis=1), np.linalg.norm(to_part, axis=1)
        apart, nearest = KDTree(to_part / depth[:, None]).query(to_skin / away[:, None])
        nearest = np.asarray(nearest, dtype=np.int64)
        covers = (apart < _APART) & (away > depth[nearest]) & (away < _FARTHEST)
        room = _EYE_MM if attached.is_eye else _TEETH_MM
        return cls(skin[covers], part[nearest[covers]], part, room)

    def held(self, wanted: np.ndarray, vertices: np.ndarray, displacement: np.ndarray) -> np.ndarray:
        """The shift (3,) of the part that comes nearest to one that is wanted and leaves it behind the skin.

        Parameters
        ----------
        wanted : (3,) array
        vertices : (V, 3) array
            The head before.
        displacement : (V, 3) array
            Where its skin goes.
        """
        outwards = vertices[self.skin] - vertices[self.part].mean(axis=0)
        away = np.linalg.norm(outwards, axis=1)
        outwards = outwards / away[:, None]
        gap = away - np.einsum("kc,kc->k", vertices[self.below] - vertices[self.part].mean(axis=0), outwards)
        limit = np.einsum("kc,kc->k", displacement[self.skin], outwards) + np.maximum(gap - self.room, 0.0)
        shift = np.array(wanted, dtype=np.float64)
        for _ in range(_ROUNDS):  # to the wall that it is farthest behind, again and again
            beyond = outwards @ shift - limit
            worst = int(beyond.argmax()) if len(beyond) else 0
            if not len(beyond) or beyond[worst] < 1e-3:
                break
            shift -= beyond[worst] * outwards[worst]
        return shift
