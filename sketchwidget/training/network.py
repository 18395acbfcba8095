"""Trains a PixelCNN with the vertex loss through the bilinear core (paper 4.3 and 4.4)."""

from __future__ import annotations

import csv
import math
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn
from torch.utils.data import DataLoader
from tqdm import tqdm

from ..face.model import FaceModel
from ..inference.network import COMPACT, Layout, PixelCNN
from .examples import Examples

_AVERAGING = 0.998  # of the weights, from step to step
_POSE_WEIGHT = 0.5  # mm that the loss counts for a standard deviation's error in every expression weight


@dataclass(frozen=True)
class Schedule:
    """How long and how fast to train.

    Parameters
    ----------
    steps : int
        Batches in all.
    batch : int
    rate : float
        Highest learning rate; warmed up to, then lowered along a cosine.
    checkpoint : int
        Steps between checkpoints.
    """

    steps: int = 6000
    batch: int = 64
    rate: float = 2e-3
    checkpoint: int = 250

    def rate_at(self, step: int) -> float:
        """Learning rate of a step: risen linearly over the first twelfth, then fallen along a cosine to nothing."""
        warm = self.steps / 12
        if step < warm:
            return self.rate * (step + 1) / warm
        return self.rate * 0.5 * (1 + math.cos(math.pi * (step - warm) / (self.steps - warm)))


def standardisation(model: FaceModel) -> dict[str, np.ndarray]:
    """Mean and standard deviation of a model's identity (p,) and expression (q,) weights, by name."""
    modes = {"identity": model.bilinear.identities, "expression": model.bilinear.expressions}
    return {
        f"{mode}_{name}": statistic
        for mode, weights in modes.items()
        for name, statistic in (("mean", weights.mean(axis=0)), ("std", weights.std(axis=0)))
    }


def standardised_poses(model: FaceModel) -> np.ndarray:
    """Standardised weights (e, q) of the expressions of a model."""
    statistics = standardisation(model)
    return (model.bilinear.expressions - statistics["expression_mean"]) / statistics["expression_std"]


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
        # Two products, one after the other: einsum over all three at once builds a (b, p, q) array of the same size.
        predicted = torch.einsum("bq,kpq,bp->bk", v, self.get_buffer("core"), u)
        difference = predicted - codes
        squared = ((difference @ self.get_buffer("metric")) * difference).sum(dim=1)
        return (squared + 0.01).sqrt().mean()


def train(
    model: FaceModel,
    metric: np.ndarray,
    examples: Examples,
    schedule: Schedule,
    folder: Path,
    layout: Layout = COMPACT,
    workers: int = 1,
) -> PixelCNN:
    """Train a network, or go on from the last checkpoint in `folder`; gives the network of averaged weights.

    The loss over time goes to `folder`/curve.csv.
    """
    torch.manual_seed(examples.seed)
    folder.mkdir(parents=True, exist_ok=True)
    network = PixelCNN(model.identity_size, model.expression_size, layout)
    network.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]
    averaged = AveragedModel(network, multi_avg_fn=get_ema_multi_avg_fn(_AVERAGING), use_buffers=True)
    loss_of = VertexLoss(model, metric)
    optimizer = torch.optim.AdamW(network.parameters(), lr=schedule.rate, weight_decay=0.01)
    checkpoint, done = folder / "checkpoint.pt", 0
    parts = {"network": network, "averaged": averaged, "optimizer": optimizer}
    if checkpoint.exists():
        state = torch.load(checkpoint, weights_only=True)
        for name, part in parts.items():
            part.load_state_dict(state[name])
        done = state["step"]
    examples.start = done
    batches = iter(DataLoader(examples, batch_size=None, num_workers=workers, prefetch_factor=4 if workers else None))

    network.train()
    began, recent = time.monotonic(), []
    with (folder / "curve.csv").open("a", newline="") as curve:
        for step in (bar := tqdm(range(done, schedule.steps), initial=done, total=schedule.steps, unit="batch")):
            images, codes, poses = next(batches)
            images = images.to(torch.float32).contiguous(memory_format=torch.channels_last)
            with torch.autocast("cpu", torch.bfloat16):
                identity, expression = network(images)
            identity, expression = identity.float(), expression.float()
            loss = loss_of(identity, expression, codes)
            # So that a broad jaw is somebody's jaw, and no puffed cheeks, though their vertices may be as near.
            pose = _POSE_WEIGHT * (expression - poses).square().mean()
            # Weak: keeps directions that no line shows near the mean.
            prior = 1e-3 * identity.square().mean()
            optimizer.zero_grad(set_to_none=True)
            (loss + pose + prior).backward()
            nn.utils.clip_grad_norm_(network.parameters(), 5.0)
            for group in optimizer.param_groups:
                group["lr"] = schedule.rate_at(step)
            optimizer.step()
            averaged.update_parameters(network)
            recent.append(loss.item())
            if (step + 1) % 50 == 0:
                csv.writer(curve).writerow([step + 1, f"{np.mean(recent):.4f}", f"{time.monotonic() - began:.0f}"])
                curve.flush()
                bar.set_postfix(mm=f"{np.mean(recent):.3f}")
                recent = []
            if (step + 1) % schedule.checkpoint == 0 or step + 1 == schedule.steps:
                state = {name: part.state_dict() for name, part in parts.items()} | {"step": step + 1}
                unfinished = checkpoint.with_suffix(".part")
                torch.save(state, unfinished)
                unfinished.rename(checkpoint)
    trained = PixelCNN(model.identity_size, model.expression_size, layout)
    trained.load_state_dict(averaged.module.state_dict())
    return trained.eval()
