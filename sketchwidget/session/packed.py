"""Vertices and textures as text: a head in a line of a session's file."""

from __future__ import annotations

import base64
import binascii
import zlib
from typing import Any

import numpy as np

from sketchwidget.face.texture import MAX_BYTES, Texture

MAX_VERTICES = 200_000
REACH = 2_000.0  # mm from the origin: ten faces
_STEP = 0.01  # mm
_MAX_TEXT = 4 * 2**20  # characters


def rounded(vertices: Any) -> np.ndarray:
    """Vertices (V, 3) float32 in millimetres as `pack` keeps them: to 0.01 mm; not writeable.

    Raises
    ------
    ValueError
        If they are not 1 to 200,000 finite points, each coordinate within 2,000 mm.
    """
    expected = f"a head has 1 to {MAX_VERTICES:,} vertices (V, 3), within {REACH:,.0f} mm of its origin"
    try:
        given = np.asarray(vertices, dtype=np.float64)
    except (OverflowError, TypeError, ValueError) as error:
        raise ValueError(f"{expected}; given {type(vertices).__name__}: {error}") from error
    if given.ndim != 2 or given.shape[1] != 3 or not 1 <= len(given) <= MAX_VERTICES:
        raise ValueError(f"{expected}; given an array of shape {given.shape}")
    if not (np.abs(given) <= REACH).all():
        raise ValueError(f"{expected}; given one that is not finite, or further away")
    return _in_millimetres(np.rint(given / _STEP).astype(np.int32))


def pack(vertices: np.ndarray) -> str:
    """Rounded vertices (V, 3) as text: differences from one to the next, compressed, in base64."""
    steps = np.rint(np.asarray(vertices, dtype=np.float64) / _STEP).astype(np.int32)
    differences = np.diff(steps, axis=0, prepend=np.zeros((1, 3), dtype=np.int32)).astype("<i4")
    # The bytes of one place together: the upper ones are nearly all alike.
    planes = np.ascontiguousarray(differences.T).view(np.uint8).reshape(-1, 4).T
    return _as_text(zlib.compress(planes.tobytes(), 6))


def unpack(text: str) -> np.ndarray:
    """Vertices (V, 3) float32 of a text by `pack`; no more than 200,000 are ever decompressed.

    Raises
    ------
    ValueError
        If the text is none.
    """
    if len(text) > _MAX_TEXT:
        raise ValueError(f"vertices are packed in up to {_MAX_TEXT:,} characters; given {len(text):,}")
    data = _unzipped(text, 12, "vertices")
    planes = np.frombuffer(data, dtype=np.uint8).reshape(4, -1)
    differences = np.ascontiguousarray(planes.T).view("<i4").reshape(3, -1).T
    return rounded(_in_millimetres(np.cumsum(differences, axis=0, dtype=np.int64)))


def pack_texture(texture: Texture | None) -> dict[str, str] | None:
    """A texture as a JSON object: "picture", the file in base64, and "uv", the places in it as `pack` has vertices."""
    if texture is None:
        return None
    differences = np.diff(texture.steps, axis=0, prepend=np.zeros((1, 2), dtype=np.uint16))  # modulo 65,536
    places = zlib.compress(np.ascontiguousarray(differences.T.astype("<u2")).tobytes(), 6)
    return {"picture": _as_text(texture.picture), "uv": _as_text(places)}


def unpack_texture(given: Any) -> Texture:
    """The texture of a JSON object by `pack_texture`; bounded as a `Texture` is.

    Raises
    ------
    ValueError
        If the object is none.
    """
    if not isinstance(given, dict) or given.keys() != {"picture", "uv"}:
        raise ValueError('a texture has a "picture" and a "uv"')
    picture, uv = given["picture"], given["uv"]
    if not isinstance(picture, str) or not isinstance(uv, str) or len(picture) > 2 * MAX_BYTES or len(uv) > _MAX_TEXT:
        raise ValueError("picture and uv of a texture are texts, packed, of bounded length")
    try:
        file = base64.b64decode(picture, validate=True)
    except (binascii.Error, ValueError) as error:
        raise ValueError(f"this is no packed picture: {error}") from error
    differences = np.frombuffer(_unzipped(uv, 4, "texture coordinates"), dtype="<u2").reshape(2, -1).T
    return Texture.of_steps(file, np.cumsum(differences, axis=0, dtype=np.uint16))


def _as_text(data: bytes) -> str:
    return base64.b64encode(data).decode()


def _unzipped(text: str, size: int, what: str) -> bytes:
    """Bytes of vertices, of a size each, that are compressed in a text: of no more than 200,000 are any made."""
    limit = size * MAX_VERTICES
    try:
        unzip = zlib.decompressobj()
        data = unzip.decompress(base64.b64decode(text, validate=True), limit + 1)
    except (binascii.Error, zlib.error, ValueError) as error:
        raise ValueError(f"these are no packed {what}: damaged, or another text") from error
    if len(data) > limit or len(data) % size or not unzip.eof or unzip.unused_data:
        raise ValueError(f"these are no packed {what}: cut short, or of more than {MAX_VERTICES:,} vertices")
    return data


def _in_millimetres(steps: np.ndarray) -> np.ndarray:
    vertices = (_STEP * steps).astype(np.float32)
    vertices.flags.writeable = False
    return vertices
