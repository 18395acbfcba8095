"""The bilinear morphable representation: a face tensor decomposed into identity and expression (paper 4.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_RCOND = 1e-3  # of least squares: weights of few people stay small in directions that hardly any mesh has


@dataclass(frozen=True)
class Bilinear:
    """A bilinear model of flattened meshes, compressed in the vertex mode too.

    ``mean + basis @ (core x_2 u x_3 v)`` is a mesh: equation 1 of DeepSketch2Face, its core ``C`` being ``basis @
    core``, on a tensor with the mean taken out (so that half precision is enough to store the basis).

    Parameters
    ----------
    mean : (d,) array
        d = 3 n flattened coordinates, millimetres.
    basis : (d, k) array
        Orthonormal columns.
    core : (k, p, q) array
    identities : (i, p) array
        Weights u of the identities of the tensor.
    expressions : (e, q) array
        Weights v of its expressions.
    """

    mean: np.ndarray
    basis: np.ndarray
    core: np.ndarray
    identities: np.ndarray
    expressions: np.ndarray

    def mesh(self, identity: np.ndarray, expression: np.ndarray) -> np.ndarray:
        """The mesh (d,) of weights (p,) and (q,)."""
        return self.mean + self.basis @ (self.core @ expression @ identity)

    def coordinates(self, meshes: np.ndarray) -> np.ndarray:
        """Coordinates (..., k) in the basis of meshes (..., d)."""
        return (meshes - self.mean) @ self.basis


def fit_identity(model: Bilinear, meshes: np.ndarray, expressions: np.ndarray) -> np.ndarray:
    """Identity weights of one person's meshes, by linear least squares over expressions that are known.

    Parameters
    ----------
    model : Bilinear
    meshes : (e, d) array
        Flattened coordinates, millimetres.
    expressions : (e, q) array
        Their expression weights.

    Returns
    -------
    (p,) float32 array
    """
    codes = model.coordinates(meshes)
    by_identity = np.einsum("kpq,eq->ekp", model.core, expressions)
    return np.linalg.lstsq(by_identity.reshape(-1, by_identity.shape[2]), codes.ravel(), rcond=None)[0].astype(
        np.float32
    )


def fit(model: Bilinear, mesh: np.ndarray, iterations: int = 10) -> tuple[np.ndarray, np.ndarray]:
    """Weights of a given mesh by alternating least squares, from the expression on that fits it best.

    Parameters
    ----------
    model : Bilinear
    mesh : (d,) array
        Flattened coordinates, millimetres, aligned as the model is.
    iterations : int

    Returns
    -------
    u : (p,) float32 array
    v : (q,) float32 array
    """
    code = model.coordinates(mesh)

    def misfit(expression: np.ndarray) -> float:
        by_identity = model.core @ expression
        return float(np.linalg.norm(by_identity @ np.linalg.lstsq(by_identity, code, rcond=_RCOND)[0] - code))

    v = min(model.expressions, key=misfit)
    u = np.linalg.lstsq(model.core @ v, code, rcond=_RCOND)[0]
    for _ in range(iterations):
        v = np.linalg.lstsq(np.einsum("kpq,p->kq", model.core, u), code, rcond=_RCOND)[0]
        u = np.linalg.lstsq(model.core @ v, code, rcond=_RCOND)[0]
    return u.astype(np.float32), v.astype(np.float32)
