"""Trains a PixelShapeCNN with the vertex loss, alone or in several processes (paper 4.3 and 4.4)."""

from __future__ import annotations

import csv
import math
import time
from dataclasses import dataclass
from pathlib import Path
from pickle import UnpicklingError
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
from .examples import Examples
from .loss import VertexLoss
from .team import Team

_AVERAGING = 0.999  # of the weights, from step to step
_POSE_WEIGHT = 0.5  # mm that the loss counts for a standard deviation's error in every expression weight


@dataclass(frozen=True)
class Schedule:
    """How long and how fast to train.

    Parameters
    ----------
    steps : int
        Batches in all, of each process.
    batch : int
    rate : float
        Highest learning rate; warmed up to, then lowered along a cosine.
    checkpoint : int
        Steps between checkpoints.
    """

    steps: int = 15_000
    batch: int = 32
    rate: float = 1.5e-3
    checkpoint: int = 500

    def rate_at(self, step: int) -> float:
        """Learning rate of a step: risen linearly over the first twelfth, then fallen along a cosine to nothing."""
        warm = self.steps / 12
        if step < warm:
            return self.rate * min(1.0, (step + 1) / warm)
        return self.rate * 0.5 * (1 + math.cos(math.pi * (step - warm) / (self.steps - warm)))


def train(
    model: FaceModel,
    metric: np.ndarray,
    examples: Examples,
    schedule: Schedule,
    folder: Path,
    layout: Layout = COMPACT,
    workers: int = 1,
    about: str = "",
) -> PixelShapeCNN:
    """Train a network, or go on from the last checkpoint in `folder`; gives the network of averaged weights.

    What a checkpoint is of, `about` and the layout, is kept in it: another training does not go on from there.

    Under ``torchrun`` each process takes its share of the batches, on a GPU of its own where there are some. The loss
    over time goes to `folder`/curve.csv.
    """
    team = Team.join()
    torch.manual_seed(examples.seed)
    folder.mkdir(parents=True, exist_ok=True)
    network = PixelShapeCNN(model.identity_size, model.expression_size, layout).to(team.device)
    network.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]
    averaged = AveragedModel(network, multi_avg_fn=get_ema_multi_avg_fn(_AVERAGING), use_buffers=True)
    loss_of = VertexLoss(model, metric).to(team.device)
    optimizer = torch.optim.AdamW(network.parameters(), lr=schedule.rate, weight_decay=0.01, fused=True)
    checkpoint, done = folder / "checkpoint.pt", 0
    parts = {"network": network, "averaged": averaged, "optimizer": optimizer}
    if checkpoint.exists():
        state = _read(checkpoint, team.device)
        if state.get("about") != about + layout.to_json():
            raise ValueError(
                f"{checkpoint} is of another training, of another layout, database or drawings: name another --out or"
                " --work, or remove it"
            )
        for name, part in parts.items():
            part.load_state_dict(state[name])
        done = state["step"]
    shared = DistributedDataParallel(network) if team.size > 1 else network
    examples.start, examples.stride = done * team.size + team.rank, team.size
    ahead = 4 if workers else None
    loader = DataLoader(
        examples, batch_size=None, num_workers=workers, prefetch_factor=ahead, worker_init_fn=_use_one_thread
    )
    batches = iter(loader)

    network.train()
    began, recent = time.monotonic(), []
    bar = tqdm(range(done, schedule.steps), initial=done, total=schedule.steps, unit="batch", disable=not team.leads)
    for step in bar:
        images, shapes, codes, poses = (batch.to(team.device) for batch in next(batches))
        images = images.to(torch.float32).contiguous(memory_format=torch.channels_last)
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
        if team.leads and (step + 1) % 50 == 0:
            means = [f"{mean:.4f}" for mean in np.mean(recent, axis=0)]
            with (folder / "curve.csv").open("a", newline="") as curve:
                csv.writer(curve).writerow([step + 1, f"{time.monotonic() - began:.0f}", *means])
            bar.set_postfix(mm=" ".join(means))
        if team.leads and ((step + 1) % schedule.checkpoint == 0 or step + 1 == schedule.steps):
            state = {name: part.state_dict() for name, part in parts.items()} | {
                "step": step + 1,
                "about": about + layout.to_json(),
            }
            unfinished = checkpoint.with_suffix(".part")
            torch.save(state, unfinished)
            unfinished.replace(checkpoint)
    trained = PixelShapeCNN(model.identity_size, model.expression_size, layout)
    trained.load_state_dict(averaged.module.state_dict())
    return trained.eval()


def _read(checkpoint: Path, device: torch.device) -> dict[str, Any]:
    try:
        return torch.load(checkpoint, weights_only=True, map_location=device)
    except (EOFError, OSError, RuntimeError, UnpicklingError) as error:
        raise ValueError(f"{checkpoint} is damaged; remove it to train anew: {error}") from error


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
