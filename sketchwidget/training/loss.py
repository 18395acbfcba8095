"""The vertex loss through the bilinear core (paper 4.3, equation 2)."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor, nn

from ..face.model import FaceModel
from .standard import standardisation


class VertexLoss(nn.Module):
    """Root mean squared distance, in mm, between predicted and true vertices (equation 2), weights by importance.

    Vertices enter by their coordinates in the model's vertex basis, in which equation 2 is a quadratic form.

    Parameters
    ----------
    model : FaceModel
    metric : (k, k) array
        See `vertex_metric`.
    """

    def __init__(self, model: FaceModel, metric: np.ndarray) -> None:
        super().__init__()
        self.register_buffer("core", torch.from_numpy(model.bilinear.core))
        self.register_buffer("metric", torch.from_numpy(metric))
        for name, values in standardisation(model).items():
            self.register_buffer(name, torch.from_numpy(values))

    def weights(self, identity: Tensor, expression: Tensor) -> tuple[Tensor, Tensor]:
        """Weights u (b, p) and v (b, q) from standardised ones."""
        mean, std = self.get_buffer("identity_mean"), self.get_buffer("identity_std")
        u = mean + std * identity
        mean, std = self.get_buffer("expression_mean"), self.get_buffer("expression_std")
        return u, mean + std * expression

    def forward(self, identity: Tensor, expression: Tensor, codes: Tensor) -> Tensor:
        """Mean loss of standardised weights (b, p) and (b, q) against codes (b, k)."""
        u, v = self.weights(identity, expression)
        by_identity = torch.einsum("bq,kpq->bkp", v, self.get_buffer("core"))
        predicted = torch.einsum("bkp,bp->bk", by_identity, u)
        difference = predicted - codes
        squared = ((difference @ self.get_buffer("metric")) * difference).sum(dim=1)
        return (squared + 0.01).sqrt().mean()  # 0.1 mm of slack: the root has no gradient at 0
