"""Higher-order singular value decomposition of a face tensor: where a bilinear model comes from."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh, svd
from tensorly.base import unfold
from tensorly.tenalg.core_tenalg import multi_mode_dot

from .bilinear import Bilinear

RANK = (50, 16)  # of identity and expression, paper 4.2
COMPONENTS = 200  # of the vertex mode: half precision and this cut cost 0.04 mm


def decompose(tensor: np.ndarray, rank: tuple[int, int], components: int) -> Bilinear:
    """Higher-order singular value decomposition of a face tensor, truncated.

    Parameters
    ----------
    tensor : (i, e, d) array
        Flattened meshes of i identities in e expressions.
    rank : (int, int)
        Identity and expression size, (50, 16) in the paper.
    components : int
        Size k of the vertex mode; it bounds the size of the stored model.

    Returns
    -------
    Bilinear

    Raises
    ------
    ValueError
        If a rank is larger than its mode.

    References
    ----------
    De Lathauwer, De Moor and Vandewalle, "A multilinear singular value decomposition", 2000.
    """
    if tensor.ndim != 3 or rank[0] > tensor.shape[0] or rank[1] > tensor.shape[1]:
        raise ValueError(f"a tensor (identities, expressions, coordinates) of {tensor.shape} has no rank {rank}")
    mean = tensor.mean(axis=(0, 1), dtype=np.float64).astype(np.float32)
    centred = tensor - mean
    identities, expressions = (_leading(unfold(centred, mode), size) for mode, size in enumerate(rank))
    core = multi_mode_dot(centred, [identities.T, expressions.T], modes=[0, 1])
    unfolded = core.reshape(-1, core.shape[-1])
    basis = _signed(svd(unfolded, full_matrices=False)[2][:components].T)
    return Bilinear(
        mean=mean,
        basis=np.ascontiguousarray(basis, dtype=np.float32),
        core=(unfolded @ basis).T.reshape(-1, *core.shape[:2]).astype(np.float32),
        identities=identities.astype(np.float32),
        expressions=expressions.astype(np.float32),
    )


def _leading(unfolded: np.ndarray, size: int) -> np.ndarray:
    """Left singular vectors (rows, size), strongest first, by way of the small Gram matrix."""
    gram = (unfolded @ unfolded.T).astype(np.float64)
    return _signed(eigh(gram)[1][:, ::-1][:, :size]).astype(np.float32)


def _signed(vectors: np.ndarray) -> np.ndarray:
    """Singular vectors (n, k) with the largest entry of each positive: libraries differ in the sign that they give."""
    largest = np.abs(vectors).argmax(axis=0)
    return vectors * np.sign(vectors[largest, np.arange(vectors.shape[1])])
