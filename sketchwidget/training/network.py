"""Trains a PixelShapeCNN with the vertex loss, alone or in several processes (paper 4.3 and 4.4)."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from threadpoolctl import threadpool_limits
from torch import Tensor, nn
from torch.nn.parallel import DistributedDataParallel
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn
from torch.utils.data import DataLoader
from tqdm import tqdm

from ..face.model import FaceModel
from ..inference.network import COMPACT, Layout, PixelShapeCNN
from .checkpoint import Checkpoints
from .curve import Curve
from .examples import Examples
from .loss import VertexLoss
from .team import Team

_AVERAGING = 0.999  # of the weights, from step to step
_WARMING_STEPS = 500  # in which the learning rate rises
_POSE_WEIGHT = 0.5  # mm that the loss counts for a standard deviation's error in every expression weight


@dataclass(frozen=True)
class Schedule:
    """How long and how fast to train.

    The learning rate rises, stays level and falls in the last fifth: until then a training is the beginning of any
    longer one.

    Parameters
    ----------
    steps : int
        Batches in all, of each process.
    batch : int
    rate : float
        Level learning rate.
    checkpoint : int
        Steps between checkpoints.
    """

    steps: int = 15_000
    batch: int = 32
    rate: float = 1.2e-3
    checkpoint: int = 400

    @property
    def level(self) -> int:
        """Steps before the learning rate falls."""
        return self.steps - self.steps // 5

    def rate_at(self, step: int) -> float:
        """Learning rate of a step."""
        if step < self.level:
            return self.rate * min(1.0, (step + 1) / _WARMING_STEPS)
        return self.rate * (1 - math.sqrt((step - self.level + 1) / (self.steps - self.level + 1)))


def train(
    model: FaceModel,
    metric: np.ndarray,
    examples: Examples,
    schedule: Schedule,
    folder: Path,
    layout: Layout = COMPACT,
    workers: int = 1,
    about: str = "",
    unseen: Examples | None = None,
) -> PixelShapeCNN:
    """Train a network, or go on from the last checkpoint in `folder`; gives the network of averaged weights.

    What a checkpoint is of, `about` and the layout, is kept in it: another training does not go on from there.

    Under ``torchrun`` each process takes its share of the batches, on a GPU of its own where there are some. The loss
    of each answer over time goes to `folder`/curve.csv, that of the averaged network on the first batch of `unseen`
    examples to `folder`/unseen.csv.
    """
    team = Team.join()
    torch.manual_seed(examples.seed)
    folder.mkdir(parents=True, exist_ok=True)
    network = PixelShapeCNN(model.identity_size, model.expression_size, layout).to(team.device)
    network.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]
    averaged = AveragedModel(network, multi_avg_fn=get_ema_multi_avg_fn(_AVERAGING), use_buffers=True)
    loss_of = VertexLoss(model, metric).to(team.device)
    optimizer = torch.optim.AdamW(network.parameters(), lr=schedule.rate, weight_decay=0.01, fused=True)
    parts = {"network": network, "averaged": averaged, "optimizer": optimizer}
    checkpoints = Checkpoints(folder, parts, about + layout.to_json())
    done, spent = checkpoints.resume(schedule.steps, schedule.level, team.device)
    shared = DistributedDataParallel(network) if team.size > 1 else network
    examples.start, examples.stride = done * team.size + team.rank, team.size
    ahead = 4 if workers else None
    loader = DataLoader(
        examples, batch_size=None, num_workers=workers, prefetch_factor=ahead, worker_init_fn=_use_one_thread
    )
    batches = iter(loader)
    curves = _curves(folder, done, layout.answers) if team.leads else None
    test = None if unseen is None else _on_device(unseen.numbered(0), team.device)

    network.train()
    began, recent = time.monotonic() - spent, []
    bar = tqdm(range(done, schedule.steps), initial=done, total=schedule.steps, unit="batch", disable=not team.leads)
    for step in bar:
        images, shapes, codes, poses = _on_device(next(batches), team.device)
        with torch.autocast(team.device.type, torch.bfloat16):
            answers = shared(images, shapes)
        losses = [
            _loss(loss_of, identity.float(), expression.float(), codes, poses) for identity, expression in answers
        ]
        optimizer.zero_grad(set_to_none=True)
        torch.stack([total for total, _ in losses]).sum().backward()
        nn.utils.clip_grad_norm_(network.parameters(), 5.0)
        for group in optimizer.param_groups:
            group["lr"] = schedule.rate_at(step)
        optimizer.step()
        averaged.update_parameters(network)
        recent = [*recent[-49:], [vertex.item() for _, vertex in losses]]
        if curves is None:
            continue
        now = step + 1
        if now % 50 == 0:
            means = np.mean(recent, axis=0).tolist()
            curves[0].add(now, time.monotonic() - began, means)
            bar.set_postfix(mm=" ".join(f"{mean:.3f}" for mean in means))
        if now % schedule.checkpoint == 0 or now in (schedule.level, schedule.steps):
            checkpoints.keep(now, time.monotonic() - began, schedule.steps, schedule.level)
            if test is not None:
                curves[1].add(now, time.monotonic() - began, _tested(averaged.module, loss_of, test))
    trained = PixelShapeCNN(model.identity_size, model.expression_size, layout)
    trained.load_state_dict(averaged.module.state_dict())
    return trained.eval()


def _curves(folder: Path, done: int, answers: tuple[str, ...]) -> tuple[Curve, Curve]:
    return Curve(folder / "curve.csv", [*answers], done), Curve(folder / "unseen.csv", [*answers], done)


def _on_device(batch: Iterable[Any], device: torch.device) -> list[Tensor]:
    images, *others = (torch.as_tensor(values).to(device) for values in batch)
    return [images.to(torch.float32).contiguous(memory_format=torch.channels_last), *others]


def _tested(network: nn.Module, loss_of: VertexLoss, batch: list[Tensor]) -> list[float]:
    """Vertex loss of each answer of a network on a batch."""
    images, shapes, codes, _ = batch
    training = network.training
    network.eval()
    with torch.inference_mode(), torch.autocast(images.device.type, torch.bfloat16):
        answers = network(images, shapes)
    network.train(training)
    return [loss_of(identity.float(), expression.float(), codes).item() for identity, expression in answers]


def _use_one_thread(_: int) -> None:
    """NumPy in a worker leaves the other cores to the network."""
    threadpool_limits(1)


def _loss(
    loss_of: VertexLoss, identity: Tensor, expression: Tensor, codes: Tensor, poses: Tensor
) -> tuple[Tensor, Tensor]:
    """What is minimised, and the vertex loss alone."""
    vertex = loss_of(identity, expression, codes)
    # So that a broad jaw is somebody's jaw, and no puffed cheeks, though their vertices may be as near.
    pose = _POSE_WEIGHT * (expression - poses).square().mean()
    # Weak: keeps directions that no line shows near the mean.
    prior = 1e-3 * identity.square().mean()
    return vertex + pose + prior, vertex
