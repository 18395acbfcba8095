"""Every expression on a head: its alignment, and deformation transfer of the poses."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..face.template import PARTS, Template
from ..geometry.alignment import similarity
from ..geometry.deformation_transfer import DeformationTransfer, deformation_gradients

FACE_HEIGHT_MM = 200.0  # menton to crown
_MENTON = 8  # iBUG landmark


class Posing:
    """Carries the expressions of one head to others.

    The skin and the mouth's lining are carried by deformation transfer (Sumner and Popovic 2004). Eyes, teeth and
    tongue, which move rigidly if at all, take over the displacement as it is: all heads are aligned and of one size.

    Parameters
    ----------
    template : Template
    poses : dict of (n, 3) arrays
        Coarse vertices of one head by expression, at rest as "neutral".
    """

    def __init__(self, template: Template, poses: Mapping[str, np.ndarray]) -> None:
        self._skin, self._faces = template.soft
        scale, centre = to_millimetres(template.subdivision @ poses["neutral"], template)
        self._rest = scale * (poses["neutral"] - centre)
        self._displacements = np.stack([scale * (pose - poses["neutral"]) for pose in poses.values()])
        moved = np.abs(self._displacements[:, self._skin]).max(axis=(0, 2))
        self._held = moved == 0
        posed = self._rest + self._displacements
        self._gradients = np.stack(
            [deformation_gradients(self._rest[self._skin], pose[self._skin], self._faces) for pose in posed]
        )

    def __call__(self, identity: np.ndarray) -> np.ndarray:
        """A resting head (n, 3), in any unit and place, in each expression: (e, n, 3) float32, millimetres."""
        rest = self.aligned(identity)
        posed = rest + self._displacements
        posed[:, self._skin] = DeformationTransfer(rest[self._skin], self._faces, self._held)(self._gradients)
        return posed.astype(np.float32)

    def aligned(self, identity: np.ndarray) -> np.ndarray:
        """A resting head (n, 3), in any unit and place, where its expressions are: (n, 3), millimetres."""
        scale, rotation, translation = similarity(identity[self._skin], self._rest[self._skin])
        return scale * identity @ rotation.T + translation


def to_millimetres(head: np.ndarray, template: Template) -> tuple[float, np.ndarray]:
    """Scale and origin that give a fine head (V, 3) its canonical size and place.

    Returns
    -------
    scale : float
        Brings menton to crown to 200 mm.
    origin : (3,) array
        The point, in the head's own units, midway between menton and crown in the plane of symmetry, and midway in
        depth.
    """
    skin = head[template.fine_parts == PARTS.index("skin")]
    menton, crown = head[template.landmarks[_MENTON], 1], skin[:, 1].max()
    depth = (skin[:, 2].min() + skin[:, 2].max()) / 2
    return FACE_HEIGHT_MM / (crown - menton), np.array([0.0, (menton + crown) / 2, depth])
