"""What a network is trained for: faces by the vertex loss or, in the paper's first two steps, classes and weights."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import cross_entropy

from ..face.model import FaceModel
from ..inference.network import PixelShapeCNN
from .face_table import FaceTable
from .loss import VertexLoss
from .standard import standardisation

_POSE_WEIGHT = 0.5  # mm that the loss counts for a standard deviation's error in every expression weight


class Task(nn.Module):
    """A network, and the losses of a batch that it is trained by.

    Parameters
    ----------
    network : PixelShapeCNN

    Attributes
    ----------
    columns : tuple of str
        What each of the losses that are told is of.
    partial : bool
        Whether parts of the network have no part in the task.
    """

    columns: tuple[str, ...] = ()
    partial = False

    def __init__(self, network: PixelShapeCNN) -> None:
        super().__init__()
        self.network = network

    def forward(self, images: Tensor, shapes: Tensor, codes: Tensor, poses: Tensor, people: Tensor) -> list[Tensor]:
        """The loss to minimise, then those to tell."""
        raise NotImplementedError

    def _answers(self, images: Tensor, shapes: Tensor) -> list[tuple[Tensor, Tensor]]:
        """What the network answers, in half precision; losses are not."""
        with torch.autocast(images.device.type, torch.bfloat16):
            answers = self.network(images, shapes)
        return [(identity.float(), expression.float()) for identity, expression in answers]


class Faces(Task):
    """The vertex loss of each of the network's answers (equation 2), all parts of the network at once.

    Parameters
    ----------
    network : PixelShapeCNN
    model : FaceModel
    metric : (k, k) array
        See `vertex_metric`.
    """

    def __init__(self, network: PixelShapeCNN, model: FaceModel, metric: np.ndarray) -> None:
        super().__init__(network)
        self.columns = network.layout.answers
        self.loss = VertexLoss(model, metric)

    def forward(self, images: Tensor, shapes: Tensor, codes: Tensor, poses: Tensor, people: Tensor) -> list[Tensor]:
        """The sum over the answers, then the vertex loss of each, mm."""
        return self._losses(self._answers(images, shapes), codes, poses)

    def _losses(self, answers: list[tuple[Tensor, Tensor]], codes: Tensor, poses: Tensor) -> list[Tensor]:
        total, told = codes.new_zeros(()), []
        for identity, expression in answers:
            vertex = self.loss(identity, expression, codes)
            # So that a broad jaw is somebody's jaw, and no puffed cheeks, though their vertices may be as near.
            pose = _POSE_WEIGHT * (expression - poses).square().mean()
            # Weak: keeps directions that no line shows near the mean.
            prior = 1e-3 * identity.square().mean()
            total = total + vertex + pose + prior
            told.append(vertex)
        return [total, *told]


class Joining(Faces):
    """The same of the one answer that joins lines and pixels, from features in place of images: all before them stays.

    Parameters
    ----------
    network : PixelShapeCNN
    model : FaceModel
    metric : (k, k) array
        See `vertex_metric`.
    """

    def __init__(self, network: PixelShapeCNN, model: FaceModel, metric: np.ndarray) -> None:
        super().__init__(network, model, metric)
        self.columns = ("shape",)
        network.requires_grad_(False)
        for layers in (network.shape_layers, network.shape_outputs):
            if layers is None:
                raise ValueError("this network sees pixels only: nothing joins them")
            layers.requires_grad_(True)

    def forward(self, images: Tensor, shapes: Tensor, codes: Tensor, poses: Tensor, people: Tensor) -> list[Tensor]:
        """The loss, then the vertex loss in it, mm; `images` are the features (b, f) of the branches."""
        branches = images.split(self.network.layout.branch, dim=1)
        with torch.autocast(images.device.type, torch.bfloat16):
            identity, expression = self.network.with_shape(list(branches), shapes)
        return self._losses([(identity.float(), expression.float())], codes, poses)


class Classes(Task):
    """Whose face it is, and in which expression: softmax layers on the branches (the first step of 4.4).

    Parameters
    ----------
    network : PixelShapeCNN
    poses : (e, q) array
        Standardised weights of each expression.
    people : int
        Rows of the table.
    """

    columns = ("identity", "expression")
    partial = True

    def __init__(self, network: PixelShapeCNN, poses: np.ndarray, people: int) -> None:
        super().__init__(network)
        self.register_buffer("poses", torch.from_numpy(poses.astype(np.float32)), persistent=False)
        self.heads = nn.ModuleList(nn.Linear(network.layout.branch, count) for count in (people, len(poses)))

    def forward(self, images: Tensor, shapes: Tensor, codes: Tensor, poses: Tensor, people: Tensor) -> list[Tensor]:
        """The sum of both cross entropies, then each."""
        with torch.autocast(images.device.type, torch.bfloat16):
            features = self.network.features(shapes if self.network.convolutions is None else images)
            scores = [head(feature) for head, feature in zip(self.heads, (features[0], features[-1]), strict=True)]
        expression = torch.cdist(poses, self.get_buffer("poses")).argmin(dim=1)
        losses = [
            cross_entropy(score.float(), wanted) for score, wanted in zip(scores, (people, expression), strict=True)
        ]
        return [torch.stack(losses).sum(), *losses]


class Weights(Task):
    """The weights u and v themselves, with the convolutions as they are (the second step of 4.4).

    Parameters
    ----------
    network : PixelShapeCNN
    identities : (i, p) array
        Standardised identity weights of each person of the table.
    """

    def __init__(self, network: PixelShapeCNN, identities: np.ndarray) -> None:
        super().__init__(network)
        self.columns = network.layout.answers
        self.register_buffer("identities", torch.from_numpy(identities.astype(np.float32)), persistent=False)
        if network.convolutions is not None:
            network.convolutions.requires_grad_(False)

    def train(self, mode: bool = True) -> Weights:
        """Normalisation in the convolutions is fixed as well."""
        super().train(mode)
        if self.network.convolutions is not None:
            self.network.convolutions.eval()
        return self

    def forward(self, images: Tensor, shapes: Tensor, codes: Tensor, poses: Tensor, people: Tensor) -> list[Tensor]:
        """The sum over the answers of the mean squared error of all weights, then that of each."""
        wanted = self.get_buffer("identities")[people]
        losses = [
            (identity - wanted).square().mean() + (expression - poses).square().mean()
            for identity, expression in self._answers(images, shapes)
        ]
        return [torch.stack(losses).sum(), *losses]


def standardised_identities(table: FaceTable, model: FaceModel) -> np.ndarray:
    """Standardised identity weights (i, p) of each person of a table, by least squares over the expressions."""
    statistics = standardisation(model)
    core = np.einsum("kpq,eq->ekp", model.bilinear.core, model.bilinear.expressions)
    solve = np.linalg.pinv(core.reshape(-1, core.shape[2]), rcond=1e-6).astype(np.float32)
    identities = table.codes.reshape(len(table.codes), -1) @ solve.T
    return (identities - statistics["identity_mean"]) / statistics["identity_std"]
