"""A portrait's head: textured, rigged, ready to be animated and exported."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import cv2
import igl
import numpy as np

from ..face.face import Face
from ..face.model import FaceModel
from ..face.texture import Texture
from ..files.whole import whole
from ..geometry.camera import Camera
from ..geometry.view import View
from .eyes import Eyeball, gaze_names
from .gltf import MorphMesh, WeightTrack, write_glb
from .neck import neck_cap
from .performance import Performance, performances
from .picture import textured
from .rig import Blend

_JPEG_QUALITY = 93


@dataclass(frozen=True, eq=False)
class Avatar:
    """An animatable cartoon head.

    Parameters
    ----------
    face : Face
        The head at rest, eyeballs in place: ``S_0`` of section 3.3.
    portrait : Face
        The head with the expression that the portrait shows.
    texture : (T, T, 3) uint8 array
    uv : (V, 2) float32 array
        Place of each vertex in the texture, 0 to 1, v upwards; the skin lies in one piece, so that it has no seam.
    eyes : list of Eyeball
        Of the head at rest, the subject's left one first.
    rig : dict of (V, 3) float32 arrays
        What each expression moves, millimetres, by ARKit's name; eyeballs turn instead.
    camera : Camera
        Of the portrait, in pixels of the picture given.
    marks : (68, 2) array
        Where the head's landmarks fall in the picture given.
    stages : dict of arrays
        The square "portrait" that was worked on and, if it was stylised, the "cartoon".
    timings : dict
        Milliseconds of each stage.
    """

    face: Face
    portrait: Face
    texture: np.ndarray
    uv: np.ndarray
    eyes: list[Eyeball]
    rig: dict[str, np.ndarray]
    camera: Camera
    marks: np.ndarray
    stages: dict[str, np.ndarray] = field(default_factory=dict)
    timings: dict[str, float] = field(default_factory=dict)

    @property
    def model(self) -> FaceModel:
        """The face model whose topology it has."""
        return self.face.model

    @cached_property
    def _blend(self) -> Blend:
        return Blend(self.face.vertices, self.rig)

    @cached_property
    def _neck_cap(self) -> np.ndarray:
        return neck_cap(self.model)

    def pose(self, weights: Mapping[str, float]) -> np.ndarray:
        """The head with some expressions: skin adds up linearly (equation 13), eyeballs turn.

        Parameters
        ----------
        weights : dict
            By ARKit's name, usually 0 to 1; what is not named is at rest.

        Returns
        -------
        (V, 3) float32 array
            Millimetres.

        Raises
        ------
        ValueError
            If a name is none, or a weight is not finite.
        """
        vertices = self._blend(weights)
        for eye in self.eyes:
            vertices[eye.vertices] = eye.points(weights)
        return vertices

    def project(self) -> np.ndarray:
        """The 68 landmarks of the head as the portrait shows it, (68, 2) in pixels of the picture given."""
        return self.marks.copy()

    def picture(
        self, weights: Mapping[str, float] | None = None, view: View | str = "front", size: int = 320
    ) -> np.ndarray:
        """A textured picture (size, size, 3) uint8; a view by its name is of the whole head, see `View.of_head`."""
        if isinstance(view, str):
            view = View.of_head(view)
        closed = np.concatenate([self.model.faces, self._neck_cap])
        return textured(self.pose(weights or {}), closed, self.uv, self.texture, view, size)

    def to_glb(self, tracks: Iterable[Performance] | None = None) -> bytes:
        """The head as a binary glTF file in metres: texture, eyeballs, every expression as a morph target.

        Parameters
        ----------
        tracks : iterable of Performance, optional
            Animations to put in; by default the ready ones.
        """
        ready = performances().values() if tracks is None else tracks
        animations = [WeightTrack(track.name, track.times, track.weights) for track in ready]
        return write_glb(self._meshes, self.jpeg, "image/jpeg", animations)

    def to_bytes(self, suffix: str) -> bytes:
        """The file that the head is exported as: "glb" as `to_glb` has it, all others are of the shape alone."""
        return self.to_glb() if suffix == "glb" else self.face.to_bytes(suffix)

    @cached_property
    def jpeg(self) -> bytes:
        """The texture as a JPEG file."""
        encoded, jpeg = cv2.imencode(
            ".jpg", cv2.cvtColor(self.texture, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY]
        )
        if not encoded:
            raise ValueError(f"the texture {self.texture.shape} cannot be encoded")
        return jpeg.tobytes()

    @cached_property
    def skin(self) -> Texture:
        """The texture and its places as `Session.take_over` takes them."""
        return Texture(self.jpeg, self.uv)

    def export(self, path: str | os.PathLike[str]) -> None:
        """Write the head to a ``.glb`` file with the ready performances; see `to_glb`.

        Raises
        ------
        ValueError
            If the suffix is another: only glTF holds texture, expressions and animation.
        """
        path = Path(path)
        if path.suffix.lower() != ".glb":
            raise ValueError(f"an avatar is exported as .glb; given {path.name!r}. For the shape alone: avatar.face")
        data = self.to_glb()
        with whole(path) as unfinished:
            unfinished.write_bytes(data)

    @property
    def _meshes(self) -> list[MorphMesh]:
        vertices, faces = self.face.vertices, self.model.faces
        normals = np.asarray(igl.per_vertex_normals(vertices.astype(np.float64), faces.astype(np.int64)))
        normals = np.where(np.isfinite(normals), normals, (0, 0, 1))
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.where(length > 1e-6, normals / np.maximum(length, 1e-6), (0, 0, 1))
        is_ball = np.zeros(len(vertices), dtype=bool)
        is_ball[np.concatenate([eye.vertices for eye in self.eyes])] = True
        kept = {"head": (np.flatnonzero(~is_ball), self.rig)}
        for eye in self.eyes:
            turned = {name: np.zeros_like(vertices) for name in gaze_names(eye.side)}
            for name, moved in turned.items():
                moved[eye.vertices] = eye.points({name: 1.0}) - eye.points()
            kept[f"{eye.side}_eye"] = (eye.vertices, turned)
        meshes = []
        for name, (members, targets) in kept.items():
            number = np.full(len(vertices), -1)
            number[members] = np.arange(len(members))
            own = number[faces]
            own, facing = own[(own >= 0).all(axis=1)], normals[members]
            if name == "head":  # the cut of the neck has an edge, and so vertices of its own
                border, closing = np.unique(self._neck_cap, return_inverse=True)
                own = np.concatenate([own, len(members) + closing.reshape(self._neck_cap.shape)])
                members = np.concatenate([members, border])
                facing = np.concatenate([facing, np.tile((0.0, -1.0, 0.0), (len(border), 1))])
            meshes.append(
                MorphMesh(
                    name,
                    vertices[members] / 1000,
                    facing,
                    self.uv[members] * (1, -1) + (0, 1),
                    own,
                    {target: moved[members] / 1000 for target, moved in targets.items()},
                )
            )
        return meshes
