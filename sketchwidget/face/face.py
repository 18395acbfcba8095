"""One head: a mesh with its lines, landmarks and files."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import trimesh

from ..files.whole import whole
from ..geometry.finite import check_finite
from ..geometry.picture import picture
from ..geometry.view import View
from ..sketch import Sketch
from .drawing import draw

if TYPE_CHECKING:
    from .model import FaceModel

FORMATS = ("obj", "ply", "stl", "glb")


@dataclass(frozen=True, eq=False)
class Face:
    """A head of a face model.

    Parameters
    ----------
    model : FaceModel
        Whose topology it has.
    vertices : (V, 3) float32 array
        Millimetres; x to the subject's left, y up, z to the front.
    identity, expression : arrays or None
        The bilinear weights it came from, if it did.

    Examples
    --------
    >>> face = sw.FaceModel.load().face(expression="smile")
    >>> face.vertices.shape, face.landmarks.shape
    ((16837, 3), (68, 3))
    >>> face.export("smile.glb")
    >>> face.sketch(wrinkles=False).lines["nose"][0].shape[1]
    2
    """

    model: FaceModel
    vertices: np.ndarray
    identity: np.ndarray | None = None
    expression: np.ndarray | None = None

    def __post_init__(self) -> None:
        vertices = np.ascontiguousarray(self.vertices, dtype=np.float32)
        expected = (len(self.model.template.fine_parts), 3)
        check_finite(vertices, expected, f"a face of this model has finite vertices {expected}", "vertex")
        vertices.flags.writeable = False
        object.__setattr__(self, "vertices", vertices)
        for name in ("identity", "expression"):
            if (weights := getattr(self, name)) is not None:
                weights = np.array(weights, dtype=np.float32)
                weights.flags.writeable = False
                object.__setattr__(self, name, weights)

    @property
    def faces(self) -> np.ndarray:
        """Triangles (F, 3) int32."""
        return self.model.faces

    @property
    def colors(self) -> np.ndarray:
        """Colour (V, 3) float32 of each vertex, between 0 and 1: skin, eyes, teeth, mouth."""
        return self.model.colors

    @property
    def landmarks(self) -> np.ndarray:
        """The 68 landmarks (68, 3), millimetres, in iBUG order."""
        return self.vertices[self.model.landmarks]

    def curve(self, name: str) -> np.ndarray:
        """Points (k, 3), millimetres, of a predefined curve.

        Raises
        ------
        KeyError
            If the model has no such curve.
        """
        if name not in self.model.curves:
            raise KeyError(f"the model's curves are {', '.join(self.model.curves)}; given {name!r}")
        return self.vertices[self.model.curves[name]]

    @property
    def mesh(self) -> trimesh.Trimesh:
        """The head as a trimesh, with vertex colours."""
        colors = (np.concatenate([self.colors, np.ones((len(self.colors), 1))], axis=1) * 255).astype(np.uint8)
        return trimesh.Trimesh(self.vertices, self.faces, vertex_colors=colors, process=False)

    def sketch(self, wrinkles: bool = True, view: View | None = None) -> Sketch:
        """The head's lines as a drawing (paper 4.1): silhouette, features and, if wanted, wrinkles.

        Parameters
        ----------
        wrinkles : bool
            Draw the outer contour of the lips and the suggestive contours of the face too, without their hidden parts.
        view : View, optional
            Where it stands on the canvas; the canonical front by default.
        """
        return draw(self.model.template, self.vertices, view or View(), self.model.wrinkles if wrinkles else None)

    def picture(self, view: View | str = "front", size: int = 320, colors: np.ndarray | None = None) -> np.ndarray:
        """A shaded picture (size, size, 3) uint8.

        Parameters
        ----------
        view : View or str
            One by its name is of the whole head; see `View.of_head`.
        size : int
            Pixels a side.
        colors : (V, 3) array, optional
            Of the vertices, between 0 and 1, as of a map of errors; the head's own by default.

        Raises
        ------
        ValueError
            If there is not one colour for each vertex, or the size is not between 1 and 4,096.
        """
        if isinstance(view, str):
            view = View.of_head(view)
        shown = self.colors if colors is None else np.asarray(colors)
        if shown.shape != self.vertices.shape:
            raise ValueError(f"this head takes colours {self.vertices.shape}; given an array of shape {shown.shape}")
        return picture(self.vertices, self.faces, shown, view, size)

    def to_bytes(self, suffix: str) -> bytes:
        """The head as a file: "obj", "ply", "stl" or "glb" (whose unit is the metre, as its standard asks).

        Raises
        ------
        ValueError
            If the suffix is another.
        """
        if suffix not in FORMATS:
            raise ValueError(f"a face is exported as one of {', '.join(FORMATS)}; given {suffix!r}")
        mesh = self.mesh
        if suffix == "glb":
            mesh.apply_scale(0.001)
        data = mesh.export(file_type=suffix)
        return data.encode() if isinstance(data, str) else bytes(data)

    def export(self, path: str | os.PathLike[str]) -> None:
        """Write the head to a file whose suffix tells the format; see `to_bytes`."""
        data = self.to_bytes(Path(path).suffix.lower().removeprefix("."))
        with whole(path) as unfinished:
            unfinished.write_bytes(data)
