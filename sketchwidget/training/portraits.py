"""Portraits of heads that are known: rendered with varied skin, hair colour, light, pose and background."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import torch
from scipy.spatial.transform import Rotation

from ..avatar.shading import shade, vertex_normals
from ..avatar.template import AvatarTemplate
from ..face.model import FaceModel
from ..geometry.camera import Camera
from ..geometry.rasterise import rasterise

_TURN = (14.0, 8.0, 5.0)  # standard deviations of yaw, pitch and roll, degrees
_MOST = 28.0


@dataclass(frozen=True, eq=False)
class KnownPortrait:
    """A picture of a head of the model, and all that made it.

    Parameters
    ----------
    image : (S, S, 3) uint8 array
    mask : (S, S) bool array
        Where the head is.
    landmarks : (68, 2) array
        Pixels.
    vertices : (V, 3) array
        Fine, millimetres.
    camera : Camera
    identity, expression, texture, light : arrays
        Bilinear weights, weights of the albedo basis, spherical-harmonics coefficients.
    """

    image: np.ndarray
    mask: np.ndarray
    landmarks: np.ndarray
    vertices: np.ndarray
    camera: Camera
    identity: np.ndarray
    expression: np.ndarray
    texture: np.ndarray
    light: np.ndarray


def render_portrait(
    model: FaceModel, template: AvatarTemplate, seed: int, side: int = 512, oversampling: int = 2
) -> KnownPortrait:
    """The portrait of a number; the same number gives the same one.

    Parameters
    ----------
    model : FaceModel
    template : AvatarTemplate
    seed : int
    side : int
        Pixels a side.
    oversampling : int
        Pixels that each is the mean of, a side.
    """
    random = np.random.default_rng([seed, 2023])
    bilinear = model.bilinear
    one, other = bilinear.identities[random.choice(len(bilinear.identities), 2, replace=False)]
    identity = one + random.uniform(0, 0.5) * (other - one)
    neutral = model.expression_weights("neutral")
    expression = neutral + random.uniform(0, 0.7) * (random.choice(bilinear.expressions) - neutral)
    vertices = model.vertices(identity.astype(np.float32), expression.astype(np.float32)).astype(np.float64)
    angles = np.clip(random.normal(0, _TURN), -_MOST, _MOST)
    scale = side / random.uniform(300, 380)
    shift = side * (0.5 + random.normal(0, 0.02, 2))
    camera = Camera(scale, Rotation.from_euler("yxz", angles, degrees=True).as_matrix(), shift)

    texture = random.normal(size=len(template.albedo_basis)) * 0.7
    light = np.array([3.1, 0.4, 0.5, 0, 0, 0, 0, 0, 0]) + random.normal(0, 0.18, 9)
    albedo = np.clip(template.albedo + np.tensordot(texture, template.albedo_basis, axes=1), 0.02, 1)
    normals = vertex_normals(torch.from_numpy(vertices), torch.from_numpy(model.faces.astype(np.int64)))
    normals = normals @ torch.from_numpy(camera.rotation.T)
    colour = shade(torch.from_numpy(model.template.subdivision @ albedo), normals, torch.from_numpy(light)).numpy()

    large = side * oversampling
    triangle, weights = rasterise(
        camera.project(vertices) * oversampling, model.faces, (large, large), camera.depth(vertices)
    )
    drawn = triangle >= 0
    picture = background(random, large)
    picture[drawn] = (colour[model.faces[triangle[drawn]]] * weights[drawn][..., None]).sum(axis=1)
    picture = cv2.resize(np.clip(picture, 0, 1), (side, side), interpolation=cv2.INTER_AREA)
    picture += random.normal(0, 0.01, picture.shape)
    mask = cv2.resize(drawn.astype(np.float32), (side, side), interpolation=cv2.INTER_AREA) > 0.5
    return KnownPortrait(
        image=np.rint(np.clip(picture, 0, 1) * 255).astype(np.uint8),
        mask=mask,
        landmarks=camera.project(vertices[model.landmarks]),
        vertices=vertices,
        camera=camera,
        identity=identity,
        expression=expression,
        texture=texture,
        light=light,
    )


def background(random: np.random.Generator, side: int) -> np.ndarray:
    """Soft patches of colour, (side, side, 3)."""
    patches = random.uniform(0, 1, (4, 4, 3)).astype(np.float32)
    return cv2.resize(patches, (side, side), interpolation=cv2.INTER_CUBIC).astype(np.float64)
