import numpy as np
import pytest
from skimage import data

from sketchwidget.avatar.stylize import EyeWarp, cartoon
from sketchwidget.portrait import FaceLandmarks


@pytest.fixture(scope="module")
def warp(portrait):
    return EyeWarp.of(FaceLandmarks(portrait[1]))


def test_the_warp_and_its_inverse_cancel(warp):
    points = np.random.default_rng(0).uniform(0, 640, (500, 2))
    assert np.allclose(warp.back(warp(points)), points, atol=1e-3)
    assert np.allclose(warp(warp.back(points)), points, atol=1e-3)


def test_eyes_grow_and_what_is_far_stays(warp, portrait):
    points = portrait[1]
    moved = warp(points)
    for eye in (slice(36, 42), slice(42, 48)):
        assert 1.1 < np.ptp(moved[eye, 0]) / np.ptp(points[eye, 0]) < 1.3
        assert np.allclose(moved[eye].mean(axis=0), points[eye].mean(axis=0), atol=1.5)
    assert np.allclose(moved[48:], points[48:]) and np.allclose(moved[3:14], points[3:14])


def test_picture_and_landmarks_are_warped_alike(warp, portrait):
    """A dot on a landmark of the eye is, in the warped picture, where the warped landmark is."""
    corner = np.rint(portrait[1][36])
    image = np.zeros((640, 640), np.float32)
    x, y = corner.astype(int)
    image[y - 2 : y + 3, x - 2 : x + 3] = 1
    row, column = np.mgrid[:640, :640]
    warped = warp.picture(image).clip(0, 1)
    found = np.array([(warped * column).sum(), (warped * row).sum()]) / warped.sum()
    assert np.allclose(found, warp(corner[None] + 0.5)[0] - 0.5, atol=0.3)


def test_a_cartoon_has_flat_areas_and_keeps_colours():
    image = data.astronaut()
    drawn = cartoon(image)
    assert drawn.shape == image.shape and drawn.dtype == np.uint8

    def roughness(picture):
        return np.median(np.abs(np.diff(picture.astype(float), axis=1)))

    assert roughness(drawn) < 0.6 * roughness(image)
    cheek = (slice(120, 135), slice(200, 212))
    assert np.abs(drawn[cheek].mean(axis=(0, 1)) - image[cheek].mean(axis=(0, 1))).max() < 40
