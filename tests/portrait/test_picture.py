import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from sketchwidget.portrait import load_picture
from sketchwidget.portrait.picture import MAX_SIDE


def encoded(pixels, kind="PNG", **options):
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, kind, **options)
    return file.getvalue()


def gradient(height=80, width=100):
    y, x = np.mgrid[:height, :width]
    return np.stack([x * 2, y * 3, 255 - x], axis=2).astype(np.uint8)


def png_header(width, height):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(b"\0" * 1000)) + chunk(b"IEND", b"")


def test_a_file_and_its_bytes_and_its_pixels_give_the_same(tmp_path):
    pixels = gradient()
    path = tmp_path / "face.png"
    path.write_bytes(encoded(pixels))
    for source in (path, str(path), path.read_bytes(), pixels):
        assert np.array_equal(load_picture(source), pixels)


def test_a_turned_photograph_comes_upright():
    pixels = gradient()
    exif = Image.Exif()
    exif[0x0112] = 6  # the camera was turned a quarter to the left
    assert np.array_equal(load_picture(encoded(pixels, exif=exif)), np.rot90(pixels, -1))


def test_transparency_is_laid_on_white():
    pixels = np.dstack([gradient(), np.zeros((80, 100), np.uint8)])
    pixels[:40, :, 3] = 255
    read = load_picture(encoded(pixels))
    assert np.array_equal(read[:40], pixels[:40, :, :3]) and (read[40:] == 255).all()
    assert np.array_equal(load_picture(pixels), read)


@pytest.mark.parametrize("value", [0, 128, 255])
def test_grey_and_16_bit_pictures_become_rgb(value):
    grey = np.full((64, 64), value, np.uint8)
    wide = grey.astype(np.uint16) * 257
    expected = np.repeat(grey[..., None], 3, axis=2)
    for source in (grey, encoded(grey), wide, encoded(wide), grey[..., None], grey / 255.0):
        assert np.array_equal(load_picture(source), expected)


def test_large_pictures_are_made_smaller():
    assert load_picture(np.zeros((3000, 1500, 3), np.uint8)).shape == (MAX_SIDE, MAX_SIDE // 2, 3)


def test_a_palette_picture_is_read():
    picture = Image.fromarray(gradient()).convert("P")
    file = io.BytesIO()
    picture.save(file, "GIF")
    assert load_picture(file.getvalue()).shape == (80, 100, 3)


@pytest.mark.parametrize(
    ("source", "told"),
    [
        (b"not a picture", "no picture"),
        (encoded(gradient())[:120], "damaged"),
        (png_header(30_000, 30_000), "megapixels"),  # 1 kB that would be 2.7 GB
        (png_header(20_000, 8_000), "megapixels"),
        (np.zeros((20, 20, 3), np.uint8), "20 x 20"),
        (np.zeros((80, 80, 5), np.uint8), "array"),
        (np.full((80, 80, 3), np.nan), "between 0 and 1; given values from nan to nan"),
        (np.linspace(-1, 2, 6400).reshape(80, 80), "given values from -1 to 2"),
        (np.zeros((80, 80, 3), np.int64), "int64"),
        (12, "given int"),
    ],
)
def test_what_is_no_good_picture_is_told(source, told):
    with pytest.raises(ValueError, match=told):
        load_picture(source)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"nobody\.png"):
        load_picture(tmp_path / "nobody.png")
