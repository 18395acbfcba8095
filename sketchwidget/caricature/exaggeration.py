"""More or less of what makes a head differ from the mean face: the deformation representation extrapolated."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from ..face.face import Face
from ..geometry.alignment import similarity
from ..geometry.deformation_representation import Deformation
from .fitting import deformable_head

LARGEST = 3.0  # beyond, nothing of a face is left

_LEAST_STRETCH = 0.1  # a surface that is extrapolated to less would turn inside out


def exaggerate(face: Face, amount: Any) -> Face:
    """A head with its differences from the mean face multiplied, in identity and expression alike.

    Rotations are multiplied in their logarithm, scale and shear in themselves, each of the head's own deformations
    being the one example of its deformation space (Wu et al. 2018, section 3.2).

    Parameters
    ----------
    face : Face
    amount : float
        From 0, the mean face, by 1, the head as it is, to 3.

    Returns
    -------
    Face

    Raises
    ------
    ValueError
        If the amount is not a number between 0 and 3.
    """
    factor = as_amount(amount)
    if factor == 1.0:
        return face
    head = deformable_head(face.model)
    representation = head.representation
    coarse = head.coarse(face.vertices)
    skin = representation.aligned(coarse[head.skin])
    own = representation.encode(skin)
    # The representation gives a head back to a quarter of a millimetre, and without its place: what is missing is
    # added, so that nothing jumps at 1.
    share = min(factor, 1.0)
    missing = skin - _centred(representation.reconstruct(own.gradients), skin)
    changed = _centred(representation.reconstruct(_multiplied(own, factor).gradients), skin) + share * missing
    _, turn, _ = similarity(skin, coarse[head.skin])
    turn = Rotation.from_rotvec(share * Rotation.from_matrix(turn).as_rotvec())
    middle, place = skin.mean(axis=0), coarse[head.skin].mean(axis=0)
    changed = turn.apply(changed - middle) + (1 - share) * middle + share * place
    # Eyes, teeth and tongue: from the mean face's to the head's own.
    vertices = (1 - share) * head.vertices(changed) + share * head.vertices(changed, coarse)
    return Face(face.model, vertices)


def as_amount(given: Any) -> float:
    """An amount of exaggeration.

    Raises
    ------
    ValueError
        If it is not a number between 0 and 3.
    """
    expected = f"an amount of exaggeration is a number from 0 to {LARGEST:g}"
    try:
        amount = float(given)
    except (OverflowError, TypeError, ValueError) as error:
        raise ValueError(f"{expected}; given {given!r}") from error
    if not 0.0 <= amount <= LARGEST:
        raise ValueError(f"{expected}; given {given!r}")
    return amount


def _multiplied(deformation: Deformation, factor: float) -> Deformation:
    own, vectors = np.linalg.eigh(deformation.stretches)
    values = np.maximum(factor * own, np.minimum(own, _LEAST_STRETCH - 1))
    stretches = (vectors * values[:, None, :]) @ vectors.swapaxes(1, 2)
    return Deformation(factor * deformation.rotations, stretches)


def _centred(vertices: np.ndarray, target: np.ndarray) -> np.ndarray:
    return vertices + (target.mean(axis=0) - vertices.mean(axis=0))
