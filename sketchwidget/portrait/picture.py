"""Pictures from anywhere as plain arrays: bounded in memory, upright, 8 bits, three channels."""

from __future__ import annotations

import io
import os
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageOps, UnidentifiedImageError

MAX_BYTES = 64 * 2**20  # of a file
MAX_PIXELS = 50_000_000  # decoded, 200 MB at most
MIN_SIDE = 64  # a face in less has no features
MAX_SIDE = 2048  # more makes no finer head

_FORMATS = ("JPEG", "PNG", "WEBP", "BMP", "TIFF", "GIF")
_SIXTEEN_BITS = ("I;16", "I;16L", "I;16B", "I;16N", "I")
_BACKGROUND = (255, 255, 255)  # behind what is transparent


def load_picture(source: Any) -> np.ndarray:
    """A picture as the rest of the package takes it.

    Files are turned upright by their EXIF tag; transparency is laid on white, grey and 16-bit pictures are widened or
    narrowed to 8-bit RGB, and of an animation the first frame is taken. What is larger than 2,048 pixels a side is made
    smaller.

    Parameters
    ----------
    source : path, bytes or array
        A JPEG, PNG, WebP, BMP, TIFF or GIF file; or an array (H, W), (H, W, 1), (H, W, 3) or (H, W, 4) of uint8,
        uint16, bool, or floating point between 0 and 1.

    Returns
    -------
    (H, W, 3) uint8 array
        Red, green, blue.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no picture, is damaged, has less than 64 pixels a side, or is larger than 64 MB or 50 megapixels;
        sizes are looked at before anything is decoded.
    """
    if isinstance(source, np.ndarray):
        return _reduced(Image.fromarray(_eight_bits(source)))
    if isinstance(source, (bytes, bytearray, memoryview)):
        return _decoded(io.BytesIO(source), memoryview(source).nbytes, "the picture")
    if not isinstance(source, (str, os.PathLike)):
        raise ValueError(f"a picture is a path, the bytes of a file or an array; given {type(source).__name__}")
    path = Path(source)
    if not path.is_file():
        raise FileNotFoundError(f"there is no picture at {path}")
    with path.open("rb") as file:
        return _decoded(file, path.stat().st_size, str(path))


def _decoded(file: Any, size: int, name: str) -> np.ndarray:
    if size > MAX_BYTES:
        raise ValueError(f"{name} has {size / 2**20:.0f} MB; at most {MAX_BYTES >> 20} MB are read: save it smaller")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # our own bound is lower and names itself
            picture = Image.open(file, formats=_FORMATS)
            _check_size(picture.width, picture.height, name)
            picture.load()
    except Image.DecompressionBombError as error:
        raise ValueError(f"{name} is too large a picture: at most {MAX_PIXELS // 10**6} megapixels are read") from error
    except UnidentifiedImageError as error:
        raise ValueError(f"{name} is no picture that can be read: give a {', '.join(_FORMATS)} file") from error
    except (OSError, SyntaxError, EOFError, IndexError) as error:
        raise ValueError(f"{name} is a damaged picture ({error}): save it anew, or give another one") from error
    return _reduced(ImageOps.exif_transpose(picture))


def _reduced(picture: Image.Image) -> np.ndarray:
    if picture.mode in _SIXTEEN_BITS:
        picture = Image.fromarray(_eight_bits(np.clip(np.asarray(picture), 0, 65535).astype(np.uint16)))
    if "A" in picture.getbands() or "transparency" in picture.info:
        picture = picture.convert("RGBA")
        ground = Image.new("RGBA", picture.size, (*_BACKGROUND, 255))
        picture = Image.alpha_composite(ground, picture)
    picture = picture.convert("RGB")
    picture.thumbnail((MAX_SIDE, MAX_SIDE), Image.Resampling.LANCZOS)
    return np.array(picture)


def _eight_bits(pixels: np.ndarray) -> np.ndarray:
    """Pixels of any range as uint8, (H, W) or (H, W, 3 or 4)."""
    if pixels.ndim == 3 and pixels.shape[2] == 1:
        pixels = pixels[..., 0]
    if pixels.ndim not in (2, 3) or (pixels.ndim == 3 and pixels.shape[2] not in (3, 4)):
        raise ValueError(f"a picture is an array (H, W), (H, W, 3) or (H, W, 4); given {pixels.shape}")
    _check_size(pixels.shape[1], pixels.shape[0], "the picture")
    if pixels.dtype == np.uint8:
        return pixels
    if pixels.dtype == np.uint16:
        return (pixels >> 8).astype(np.uint8)
    if pixels.dtype == bool:
        return pixels.astype(np.uint8) * 255
    if np.issubdtype(pixels.dtype, np.floating):
        if not np.isfinite(pixels).all() or pixels.min() < 0 or pixels.max() > 1:
            raise ValueError(
                "a picture of floating-point numbers has values between 0 and 1; given values from"
                f" {pixels.min():g} to {pixels.max():g}"
            )
        return np.rint(pixels * 255).astype(np.uint8)
    raise ValueError(f"a picture's values are uint8, uint16, bool or floating point; given {pixels.dtype}")


def _check_size(width: int, height: int, name: str) -> None:
    if min(width, height) < MIN_SIDE:
        raise ValueError(f"{name} has {width} x {height} pixels; a face needs at least {MIN_SIDE} a side")
    if width * height > MAX_PIXELS:
        raise ValueError(
            f"{name} has {width} x {height} pixels; at most {MAX_PIXELS // 10**6} megapixels are read: make it smaller"
        )
