"""A picture that lies on a head."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
import trimesh
from PIL import Image
from trimesh.visual import TextureVisuals

from .face import Face

MAX_BYTES = 8 * 2**20  # of the picture's file
MAX_SIDE = 4096  # pixels

_FORMATS = ("JPEG", "PNG")
_STEPS = 2**16 - 1  # of a texture coordinate: a sixteenth of a pixel, at least


@dataclass(frozen=True, eq=False)
class Texture:
    """A picture, and where each vertex of a head lies in it.

    Parameters
    ----------
    picture : bytes
        A JPEG or PNG file.
    uv : (V, 2) array
        Places of the vertices, 0 to 1, v upwards; kept as float32, rounded to steps of 1/65535.

    Raises
    ------
    ValueError
        If the picture is no such file, is larger than 8 MB or 4,096 pixels a side, or a place lies outside of it; the
        picture is not decoded.
    """

    picture: bytes
    uv: np.ndarray

    def __post_init__(self) -> None:
        if not isinstance(self.picture, bytes) or len(self.picture) > MAX_BYTES:
            given = f"{len(self.picture):,} bytes" if isinstance(self.picture, bytes) else type(self.picture).__name__
            raise ValueError(
                f"the picture of a texture is the bytes of a file, {MAX_BYTES >> 20} MB at most; given {given}"
            )
        try:
            width, height = Image.open(io.BytesIO(self.picture), formats=_FORMATS).size
        except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
            raise ValueError("the picture of a texture is a JPEG or PNG file; given something else") from error
        if max(width, height) > MAX_SIDE:
            raise ValueError(
                f"the picture of a texture has at most {MAX_SIDE} pixels a side; given {width} x {height} pixels"
            )
        uv = np.asarray(self.uv, dtype=np.float64)
        if uv.ndim != 2 or uv.shape[1] != 2 or not ((uv >= 0) & (uv <= 1)).all():
            raise ValueError(f"texture coordinates are an array (V, 2) between 0 and 1; given one of shape {uv.shape}")
        uv = (np.rint(uv * _STEPS) / _STEPS).astype(np.float32)
        uv.flags.writeable = False
        object.__setattr__(self, "uv", uv)

    @property
    def steps(self) -> np.ndarray:
        """The places as whole numbers (V, 2) uint16, of which 65,535 are the picture's side."""
        return np.rint(self.uv.astype(np.float64) * _STEPS).astype(np.uint16)

    @classmethod
    def of_steps(cls, picture: bytes, steps: np.ndarray) -> Texture:
        """A texture whose places are given as `steps` has them."""
        return cls(picture, steps / _STEPS)


@dataclass(frozen=True, eq=False)
class TexturedFace:
    """A head on which a texture lies, as a file of its own."""

    face: Face
    texture: Texture

    def to_bytes(self, suffix: str) -> bytes:
        """The file that the head is exported as: "glb" has the texture, all others are of the shape alone."""
        if suffix != "glb":
            return self.face.to_bytes(suffix)
        image = Image.open(io.BytesIO(self.texture.picture), formats=_FORMATS)
        skin = TextureVisuals(uv=self.texture.uv, image=image)
        mesh = trimesh.Trimesh(self.face.vertices / 1000, self.face.faces, visual=skin, process=False)
        data = mesh.export(file_type=suffix)
        return data.encode() if isinstance(data, str) else bytes(data)
