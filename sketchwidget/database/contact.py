"""Lips that do not cross, lids that do not enter the eyeball, teeth that stay behind the skin.

Lips and lids are tested on the fine mesh, and all is mended on the coarse one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.ndimage import gaussian_filter1d
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from ..face.template import PARTS, Template
from ..geometry.edges import edge_distance, edge_graph
from ..geometry.intersection import intersecting
from ..geometry.smoothstep import smoothstep
from ..geometry.visibility import covering

_LIP_MM, _LID_MM = 9.0, 8.0  # how far from the lips' contact and the lids' margins both are looked for
_LIP_REACH = 16.0  # how far from the contact the lips move when they part
_GAP_MM = 0.05  # between lips that were parted
_CLEARANCE_MM = 0.15  # of lids over the eyeball
_TEETH_MM = 1.5  # of skin in front of the teeth
_COVER_MM = 10.0  # behind the teeth: skin that lies deeper is the back of the head, seen through an open mouth
_FAR = 60.0  # mm: distances along the surface end there
_STEP = 1.0  # mm along the mouth
_ROUNDS = 6
_SAMPLES = np.array([[i, j, 4 - i - j] for i in range(5) for j in range(5 - i)]) / 4  # barycentric, of a triangle


@dataclass(frozen=True)
class _Lips:
    fine: sparse.csr_matrix  # their fine vertices from coarse ones
    upper: np.ndarray  # triangles of these
    lower: np.ndarray
    share: np.ndarray  # (n,) of coarse vertices: how much each rises (or, below 0, falls) when the lips part


@dataclass(frozen=True)
class _Eye:
    ball: sparse.csr_matrix  # fine vertices of the eyeball from coarse ones
    lid: sparse.csr_matrix  # and those of the lids
    leaning: sparse.csr_matrix  # 1 where a fine vertex of the lids leans on a coarse one
    lid_faces: np.ndarray  # triangles of the whole fine mesh
    ball_faces: np.ndarray


class Contact:
    """Where the parts of a head touch.

    Parameters
    ----------
    template : Template
    rest : (n, 3) array
        Coarse vertices of a typical head at rest, millimetres: distances along its surface tell upper from lower lip.
    """

    def __init__(self, template: Template, rest: np.ndarray) -> None:
        self._template = template
        fine = template.subdivision @ rest

        def along_surface(*names: str) -> np.ndarray:
            starts = np.concatenate([template.curves[name] for name in names])
            return np.minimum(edge_distance(fine, template.faces, starts, _FAR), _FAR)

        self._lips = self._find_lips(along_surface("mouth_upper"), along_surface("mouth_lower"))
        has_eyes = (template.parts == PARTS.index("eyes")).any()
        self._eyes = [
            self._find_eye(fine, side, along_surface(f"{side}_eye_upper", f"{side}_eye_lower"))
            for side in (("left", "right") if has_eyes else ())
        ]
        self._skin = template.faces[(template.fine_parts[template.faces] == PARTS.index("skin")).all(axis=1)]
        self._rows = self._find_teeth(rest)

    def _find_teeth(self, rest: np.ndarray) -> list[np.ndarray]:
        """Coarse vertices of the upper and of the lower teeth."""
        teeth = np.flatnonzero(self._template.parts == PARTS.index("teeth"))
        upper = rest[teeth, 1] > rest[teeth, 1].mean() if len(teeth) else np.zeros(0, dtype=bool)
        return [row for row in (teeth[upper], teeth[~upper]) if len(row)]

    def _find_lips(self, from_upper: np.ndarray, from_lower: np.ndarray) -> _Lips:
        template = self._template
        soft = template.fine_parts <= PARTS.index("mouth")
        sides = [
            soft & (own < _LIP_MM) & (own < other - 1.0)
            for own, other in ((from_upper, from_lower), (from_lower, from_upper))
        ]
        upper, lower = (template.faces[side[template.faces].all(axis=1)] for side in sides)
        coarse = slice(template.coarse_count)  # the first fine vertices are the coarse ones
        near = np.minimum(from_upper, from_lower)[coarse]
        difference = np.clip((from_lower - from_upper)[coarse], -3.0, 3.0) / 3.0
        share = difference * (1 - smoothstep(near, 0.0, _LIP_REACH)) * (template.parts <= PARTS.index("mouth"))
        used = np.unique(np.concatenate([upper, lower]))
        return _Lips(template.subdivision[used], np.searchsorted(used, upper), np.searchsorted(used, lower), share)

    def _find_eye(self, fine: np.ndarray, side: str, from_margin: np.ndarray) -> _Eye:
        template = self._template
        margin = np.unique(np.concatenate([template.curves[f"{side}_eye_{part}"] for part in ("upper", "lower")]))
        middle = fine[margin].mean(axis=0)
        is_ball = template.fine_parts == PARTS.index("eyes")
        ball = np.flatnonzero(is_ball & (np.sign(fine[:, 0]) == np.sign(middle[0])))
        # What the margin parts from the rest of the skin is the socket, behind the lids.
        skin = template.fine_parts == PARTS.index("skin")
        skin[margin] = False
        edges = template.faces[skin[template.faces].all(axis=1)]
        label = connected_components(edge_graph(fine, edges), directed=False)[1]
        outside = skin & (label == np.bincount(label[skin]).argmax())
        outside[margin] = True
        lid = outside & (from_margin < _LID_MM)
        leaning = template.subdivision[lid]
        leaning.data = (leaning.data > 0.1).astype(leaning.dtype)
        return _Eye(
            ball=template.subdivision[ball],
            lid=template.subdivision[lid],
            leaning=leaning,
            lid_faces=template.faces[lid[template.faces].all(axis=1)],
            ball_faces=template.faces[np.isin(template.faces, ball).all(axis=1)],
        )

    def crossing(self, head: np.ndarray) -> dict[str, int]:
        """Pairs of triangles that cut each other in a head (n, 3): of the two "lips", and of "lids" and eyeballs."""
        fine = self._template.subdivision @ head
        return {
            "lips": len(self._crossing_lips(self._lips.fine @ head)),
            "lids": sum(len(intersecting(fine, eye.lid_faces, eye.ball_faces)) for eye in self._eyes),
        }

    def mended(self, head: np.ndarray) -> np.ndarray:
        """A head (n, 3) with lips parted where they cross, lids lifted off the eyeballs, and teeth behind the skin."""
        return self.seated(self.parted(head))

    def parted(self, head: np.ndarray) -> np.ndarray:
        """The same but for the teeth: a head (n, 3) with lips parted and lids lifted."""
        head = np.array(head, dtype=np.float64)
        for eye in self._eyes:
            for _ in range(_ROUNDS):
                if not self._lift_lids(head, eye):
                    break
        for _ in range(_ROUNDS):
            lips = self._lips.fine @ head
            if not len(self._crossing_lips(lips)):
                break
            self._part_lips(head, lips)
        return head

    def seated(self, head: np.ndarray) -> np.ndarray:
        """A head (n, 3) with each row of its teeth moved back by as much as some of it comes through the skin."""
        head = np.array(head)
        skin = self._template.subdivision @ head
        for row in self._rows:
            point, above = covering(head[row], skin, self._skin)
            near = above > -_COVER_MM
            outermost = np.full(len(row), -np.inf)
            np.maximum.at(outermost, point[near], above[near])
            covered = np.isfinite(outermost)
            head[row, 2] -= np.maximum(_TEETH_MM - outermost[covered], 0.0).max(initial=0.0)
        return head

    def _crossing_lips(self, lips: np.ndarray) -> np.ndarray:
        return intersecting(lips, self._lips.upper, self._lips.lower)

    def _lift_lids(self, head: np.ndarray, eye: _Eye) -> bool:
        """Move what of the lids is too near to the eyeball away from its middle; whether there was any."""
        ball, lid = eye.ball @ head, eye.lid @ head
        low, high = ball.min(axis=0), ball.max(axis=0)
        # The cornea stands out of the ball in front.
        radius = (high - low)[:2].mean() / 2
        middle = np.array([*((low + high) / 2)[:2], low[2] + radius])
        ball, lid = ball - middle, lid - middle
        height, distance = np.linalg.norm(ball, axis=1), np.linalg.norm(lid, axis=1)
        away, nearest = KDTree(ball / height[:, None]).query(lid / distance[:, None], k=4)
        weight = 1 / np.maximum(away, 1e-6)
        under = (weight * height[nearest]).sum(axis=1) / weight.sum(axis=1)
        lift = np.maximum(under + _CLEARANCE_MM - distance, 0.0)
        if lift.max() < 0.1 * _CLEARANCE_MM:
            return False
        # A coarse vertex rises by the most that a fine vertex that leans on it needs.
        rise = sparse.csr_matrix(eye.leaning.multiply(lift[:, None])).max(axis=0).toarray().ravel()
        outwards = head - middle
        head += outwards * (rise / np.linalg.norm(outwards, axis=1))[:, None]
        return True

    def _part_lips(self, head: np.ndarray, lips: np.ndarray) -> None:
        """Raise the upper lip and lower the other by as much as they overlap, along the whole breadth of the mouth."""
        low, high = lips.min(axis=0), lips.max(axis=0)
        columns, rows = (int(np.ceil((high - low)[axis] / _STEP)) + 1 for axis in (0, 2))

        def heights(triangles: np.ndarray, highest: bool) -> np.ndarray:
            """Greatest or least y (columns, rows) of triangles (k, 3, 3), sampled, over cells in x and z."""
            points = (_SAMPLES @ triangles).reshape(-1, 3)
            x, z = (((points[:, axis] - low[axis]) / _STEP).astype(int) for axis in (0, 2))
            field = np.full((columns, rows), -np.inf if highest else np.inf)
            (np.maximum if highest else np.minimum).at(field, (x, z), points[:, 1])
            return field

        overlap = heights(lips[self._lips.lower], True) - heights(lips[self._lips.upper], False)
        by_column = np.maximum(overlap.max(axis=1, initial=-np.inf), 0.0)
        by_column[by_column > 0] += _GAP_MM
        spread = np.maximum(gaussian_filter1d(by_column, 2.0), by_column)
        x = (head[:, 0] - low[0]) / _STEP
        head[:, 1] += 0.5 * self._lips.share * np.interp(x, np.arange(columns) + 0.5, spread)
