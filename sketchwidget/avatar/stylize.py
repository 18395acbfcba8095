"""A portrait as a cartoon. Without a network: flat colours, drawn edges, large eyes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np

from ..portrait.landmarks import EYES, FaceDetector, FaceLandmarks
from .stylegan import Generator, picture, project, swap_layers

_SIDE = 512.0  # pixels of the picture that the sizes below are for
_BILATERAL = (9, 28.0, 7.0)  # diameter, and spreads in colour and space
_PRESERVING = (18.0, 0.28)  # spreads of the edge-preserving filter in space and in colour
_LEVELS, _SOFTNESS = 9, 0.35  # of lightness; 0 is a hard step
_SATURATION, _BRIGHTNESS = 1.18, 1.04
_EDGE_SIGMA, _EDGE_RATIO, _EDGE_GAIN, _EDGE_DARK = 1.0, 1.6, 9.0, 0.35  # extended difference of Gaussians
_EYES_LARGER = 0.24  # by what share, in the middle of an eye
_EYE_REACH = 1.5  # of the breadth of an eye: where the enlargement ends


@dataclass(frozen=True, eq=False)
class Stylized:
    """A stylised portrait.

    Parameters
    ----------
    image : (H, W, 3) uint8 array
    marks : FaceLandmarks
        In its pixels.
    back : function
        Takes points (n, 2) of it to where they are in the portrait.
    """

    image: np.ndarray
    marks: FaceLandmarks
    back: Callable[[np.ndarray], np.ndarray]


class Stylizer(Protocol):
    """Draws portraits; any function with these arguments serves."""

    def __call__(self, image: np.ndarray, marks: FaceLandmarks) -> Stylized:
        """Draw a square portrait (H, H, 3) uint8 with the marks of its face."""
        ...


def drawn(image: np.ndarray, marks: FaceLandmarks) -> Stylized:
    """The usual stylizer: eyes enlarged, then the cartoon filter."""
    warp = EyeWarp.of(marks)
    return Stylized(cartoon(warp.picture(image)), marks.moved(warp), warp.back)


class StyleGanStylizer:
    """Draws portraits by two StyleGAN2 generators whose layers are swapped.

    Parameters
    ----------
    base, other : dict of tensors
        State dicts of a generator of photographs and of the same trained on with cartoons; see `load_generator`.
    resolution : int
        Layers up to this one come from the cartoons' generator.
    detector : FaceDetector
        Finds the face again in what was drawn, which has other shapes than the portrait.
    steps : int
        Of the search for the codes of a portrait.

    Raises
    ------
    ValueError
        If the generators do not fit each other or are none.
    """

    def __init__(self, base: dict, other: dict, resolution: int, detector: FaceDetector, steps: int = 200) -> None:
        self._photographs = Generator.of(base)
        self._cartoons = Generator.of(swap_layers(base, other, resolution))
        self._detector, self._steps = detector, steps

    def __call__(self, image: np.ndarray, marks: FaceLandmarks) -> Stylized:
        """Draw a square portrait; a ValueError if no face is found in what was drawn."""
        codes = project(self._photographs, image, self._steps)
        made = cv2.resize(picture(self._cartoons, codes), image.shape[1::-1], interpolation=cv2.INTER_CUBIC)
        boxes = self._detector.faces(made)
        if not len(boxes):
            raise ValueError("no face is found in the cartoon: swap fewer layers, or take stylize=True")
        return Stylized(made, self._detector.landmarks(made, boxes[0]), lambda points: points)


@dataclass(frozen=True)
class EyeWarp:
    """Enlarges the eyes of a picture and all marks in it.

    About the middle of each eye, a point of the new picture shows what was ``1 - strength (1 - (r / reach)^2)^2`` as
    far from the middle; beyond the reach nothing moves.

    Parameters
    ----------
    middles : tuple of (2,) arrays
        Pixels.
    reaches : tuple of float
        Pixels.
    strength : float
        Below 0.6, so that nothing folds.
    """

    middles: tuple[np.ndarray, ...]
    reaches: tuple[float, ...]
    strength: float

    @classmethod
    def of(cls, marks: FaceLandmarks, larger: float = _EYES_LARGER) -> EyeWarp:
        """The warp that makes the eyes of a face larger by a share."""
        corners = [marks.points[eye][[0, 3]] for eye in EYES.values()]
        middles = tuple(pair.mean(axis=0) for pair in corners)
        reaches = tuple(_EYE_REACH * float(np.linalg.norm(pair[1] - pair[0])) for pair in corners)
        return cls(middles, reaches, 1 - 1 / (1 + larger))

    def back(self, points: np.ndarray) -> np.ndarray:
        """Points (..., 2) of the enlarged picture in the one before."""
        result = np.array(points, dtype=np.float64)
        for middle, reach in zip(self.middles, self.reaches, strict=True):
            offset = np.asarray(points) - middle
            share = np.minimum((offset**2).sum(axis=-1, keepdims=True) / reach**2, 1.0)
            result -= self.strength * (1 - share) ** 2 * offset
        return result

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Points (..., 2) of the picture before in the enlarged one."""
        points = np.asarray(points, dtype=np.float64)
        moved = points.copy()
        for _ in range(60):  # what `back` takes to the points; it is a contraction
            moved = moved + points - self.back(moved)
        return moved

    def picture(self, image: np.ndarray) -> np.ndarray:
        """The picture (H, W, ...) with its eyes enlarged."""
        row, column = np.mgrid[: image.shape[0], : image.shape[1]]
        source = (self.back(np.stack([column + 0.5, row + 0.5], axis=-1)) - 0.5).astype(np.float32)
        x, y = cv2.split(source)
        return cv2.remap(image, x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)


def cartoon(image: np.ndarray) -> np.ndarray:
    """A picture in flat colours with dark edges.

    Smoothed twice with edges kept (bilateral and domain-transform filters), lightness gathered in soft steps, and the
    lines of an extended difference of Gaussians drawn over it.

    Parameters
    ----------
    image : (H, W, 3) uint8 array

    Returns
    -------
    (H, W, 3) uint8 array

    References
    ----------
    Winnemöller, Kyprianidis and Olsen, "XDoG: an extended difference-of-Gaussians compendium", 2012; Gastal and
    Oliveira, "Domain transform for edge-aware image and video processing", 2011.
    """
    size = max(image.shape[:2]) / _SIDE
    diameter, colour, space = _BILATERAL
    smooth = cv2.bilateralFilter(image, max(3, round(diameter * size)), colour, space * size)
    smooth = cv2.edgePreservingFilter(
        smooth, flags=cv2.RECURS_FILTER, sigma_s=_PRESERVING[0] * size, sigma_r=_PRESERVING[1]
    )
    lab = cv2.cvtColor(smooth.astype(np.float32) / 255, cv2.COLOR_RGB2LAB)
    lab[..., 0] = np.clip(_stepped(lab[..., 0] / 100 * _BRIGHTNESS), 0, 1) * 100
    lab[..., 1:] *= _SATURATION
    flat = np.clip(cv2.cvtColor(lab, cv2.COLOR_LAB2RGB), 0, 1)
    return np.rint(flat * _edges(smooth, size)[..., None] * 255).astype(np.uint8)


def _stepped(lightness: np.ndarray) -> np.ndarray:
    """Lightness, 0 to 1, drawn towards the middles of its levels."""
    level = np.floor(lightness * _LEVELS)
    within = lightness * _LEVELS - level - 0.5
    return (level + 0.5 + 0.5 * np.tanh(within / _SOFTNESS) / np.tanh(0.5 / _SOFTNESS)) / _LEVELS


def _edges(image: np.ndarray, size: float) -> np.ndarray:
    """1 where nothing is drawn, less on edges: (H, W)."""
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY).astype(np.float32) / 255
    fine = cv2.GaussianBlur(grey, (0, 0), _EDGE_SIGMA * size)
    coarse = cv2.GaussianBlur(grey, (0, 0), _EDGE_SIGMA * _EDGE_RATIO * size)
    drawn = 1 + np.tanh(np.minimum(_EDGE_GAIN * (fine - coarse) + 0.05, 0))
    return 1 - _EDGE_DARK * (1 - drawn)
