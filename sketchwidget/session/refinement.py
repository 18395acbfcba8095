"""Gesture-based refinement: what is marked on a head, and what gestures made of it (paper 3.3)."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import igl
import numpy as np
from scipy.spatial import KDTree

from sketchwidget.geometry.region_deformation import within_reach
from sketchwidget.geometry.view import View
from sketchwidget.geometry.visibility import covering, visible_vertices
from sketchwidget.sketch import resample

from .layers import Displacement, Layers

if TYPE_CHECKING:
    from sketchwidget.face import Face

    from .events import Brush, Gesture
    from .modeller import Modeller
    from .state import State

REACH = 40.0  # mm about the handles that go along with them while no region is chosen
BESIDE = 0.02  # canvas units from the head that count as on it: the width of a pen
BORDER = (6.0, 12.0)  # mm from the border within which handles go less far: as far as they were to go, within these
FARTHEST = 100.0  # mm that a vertex can be refined by: half the height of a face


@dataclass(frozen=True, eq=False)
class Refinement:
    """What the refinement mode knows of a head.

    Parameters
    ----------
    handles : (h,) int32 array
        The vertices that are marked, in order.
    region : (V,) bool array, optional
        What may move; None is everything.
    layer : Displacement, optional
        What gestures changed so far.
    """

    handles: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int32))
    region: np.ndarray | None = None
    layer: Displacement | None = None


UNREFINED = Refinement()


@dataclass(frozen=True, eq=False)
class Edit:
    """A stroke on a head, for a behaviour to make something of it.

    Parameters
    ----------
    points : (n, 2) float32 array
        The stroke, canvas points.
    view : View
        How the head was seen.
    layers : Layers
        Of the head on show.
    refinement : Refinement
        What is marked, and done so far.
    modeller : Modeller
    """

    points: np.ndarray
    view: View
    layers: Layers
    refinement: Refinement
    modeller: Modeller

    @classmethod
    def of(cls, event: Gesture, state: State, modeller: Modeller) -> Edit:
        """A gesture on the head of a state."""
        shown = modeller.head(state)
        return cls(event.points, event.view_in(shown.frame), shown.layers, state.refinement, modeller)

    @property
    def face(self) -> Face:
        """The head on show."""
        return self.layers.head

    @cached_property
    def movable(self) -> np.ndarray:
        """What may move, (V,) bool: skin and mouth within the region of interest."""
        soft = self.modeller.soft
        return soft if self.refinement.region is None else soft & self.refinement.region

    @property
    def handles(self) -> np.ndarray:
        """The marked vertices that may move, (h,) int."""
        return self.refinement.handles[self.movable[self.refinement.handles]]

    @property
    def towards_viewer(self) -> np.ndarray:
        """Unit vector (3,)."""
        return self.view.rotation[2]

    @property
    def canvas(self) -> np.ndarray:
        """All vertices on the canvas, (V, 2)."""
        return self.view.project(self.face.vertices)

    @cached_property
    def normals(self) -> np.ndarray:
        """Outward unit vectors (V, 3) at the vertices of the head on show."""
        faces = self.face.faces.astype(np.int64)
        return np.asarray(igl.per_vertex_normals(self.face.vertices.astype(np.float64), faces))

    def in_space(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors of the canvas (..., 2) as vectors in the view plane (..., 3), millimetres."""
        return (np.asarray(vectors) * [1.0, -1.0] / self.view.scale) @ self.view.rotation[:2]

    @cached_property
    def on_head(self) -> bool:
        """Whether some of the stroke lies over the head, or right beside its outline."""
        stroke = resample(self.points, 64)
        if KDTree(self.canvas).query(stroke)[0].min() < BESIDE:
            return True
        places = np.pad((stroke - self.view.centre) * [1.0, -1.0] / self.view.scale, ((0, 0), (0, 1)))
        return len(covering(places, self.face.vertices @ self.view.rotation.T, self.face.faces)[0]) > 0

    def seen(self, vertices: np.ndarray) -> np.ndarray:
        """Which of some vertices (k,) are seen in this view, (k,) bool."""
        return visible_vertices(self.face.vertices, self.face.faces, self.view.rotation, vertices)

    def deformed(self, vertices: np.ndarray, displacement: np.ndarray, border: np.ndarray | None = None) -> Refinement:
        """The refinement in which some vertices (k,) went by (k, 3) millimetres, and the region after them.

        While no region is chosen, what is up to 40 mm away along the surface goes along. Near the border of one, less
        and less of the way is gone, so that there is no step at the border: that of vertices `border` (b,), by default
        of all that lie outside.

        Raises
        ------
        ValueError
            If there are no vertices, some may not move, or something would go too far.
        """
        if self.refinement.region is None:
            rest = self.modeller.model.mean
            movable = self.movable & within_reach(rest, self.face.faces, vertices, REACH)
        else:
            movable = self.movable
        deformation = self.modeller.deformation(movable, vertices)
        farthest = float(np.linalg.norm(displacement, axis=1).max())
        shares = deformation.fading(np.clip(farthest, *BORDER), border)
        return self.displaced(deformation.displacement(shares[:, None] * displacement))

    def displaced(self, displacement: np.ndarray) -> Refinement:
        """The refinement in which all vertices went by (V, 3) millimetres, as far as they may move.

        Raises
        ------
        ValueError
            If the displacement is not finite, or something would go too far.
        """
        displacement = np.asarray(displacement, dtype=np.float64)
        if displacement.shape != self.face.vertices.shape or not np.isfinite(displacement).all():
            raise ValueError(
                f"a displacement is finite, of shape {self.face.vertices.shape}; given shape {displacement.shape}"
            )
        moved = np.where(self.movable[:, None], displacement, 0.0)
        region = self.refinement.region
        for part, cover in zip(self.modeller.attached, self.modeller.covers, strict=True):
            # Eyes, teeth and tongue go along as they are; even outside of the region, they do not come through skin.
            along = region is None or region[part.vertices].all()
            wanted = moved[part.leaders].mean(axis=0) if along else np.zeros(3)
            moved[part.vertices] = cover.held(wanted, self.face.vertices, moved)
        layer = Displacement(moved.astype(np.float32))
        if self.refinement.layer is not None:
            layer = layer + self.refinement.layer
        if (farthest := float(np.linalg.norm(layer.offsets, axis=1).max())) > FARTHEST:
            raise ValueError(f"a head is refined by up to {FARTHEST:.0f} mm; this would make it {farthest:.0f} mm")
        return replace(self.refinement, layer=layer)


def brushed(state: State, event: Brush, modeller: Modeller) -> State:
    """The state with vertices marked, or unmarked.

    Raises
    ------
    ValueError
        If the head has no such vertices, or all are of parts that do not deform.
    """
    count = len(modeller.soft)
    beyond = event.vertices[(event.vertices < 0) | (event.vertices >= count)]
    if len(beyond):
        raise ValueError(f"the vertices of this head are numbered from 0 to {count - 1}; given {beyond[0]}")
    before = state.refinement.handles
    if event.erase:
        handles = np.setdiff1d(before, event.vertices)
    else:
        soft = event.vertices[modeller.soft[event.vertices]]
        if len(event.vertices) and not len(soft):
            raise ValueError("eyes, teeth and tongue go along with the skin about them: mark that")
        handles = np.union1d(before, soft)
    if len(handles) == len(before):
        return state
    return replace(state, refinement=replace(state.refinement, handles=handles.astype(np.int32)))


def unmarked(state: State) -> State:
    """The state without handles and without a region; what was refined stays."""
    refinement = state.refinement
    if not len(refinement.handles) and refinement.region is None:
        return state
    return replace(state, refinement=Refinement(layer=refinement.layer))
