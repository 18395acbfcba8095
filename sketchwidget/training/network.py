"""Trains a network, alone or in several processes (paper 4.4)."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from threadpoolctl import threadpool_limits
from torch import Tensor, nn
from torch.nn.parallel import DistributedDataParallel
from torch.optim.swa_utils import AveragedModel
from torch.utils.data import DataLoader
from tqdm import tqdm

from ..inference.network import PixelShapeCNN
from .checkpoint import Checkpoints
from .curve import Curve
from .examples import Batches
from .tasks import Task
from .team import Team

_CURVES = ("curve.csv", "unseen.csv")


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
    warming : int
        Steps in which the learning rate rises.
    averaging : float
        Share that the averaged weights, which are what a training gives, keep from step to step; less at first.
    """

    steps: int = 15_000
    batch: int = 32
    rate: float = 1.2e-3
    checkpoint: int = 400
    warming: int = 500
    averaging: float = 0.999

    @property
    def level(self) -> int:
        """Steps before the learning rate falls."""
        return self.steps - self.steps // 5

    def rate_at(self, step: int) -> float:
        """Learning rate of a step."""
        if step < self.level:
            return self.rate * min(1.0, (step + 1) / self.warming)
        return self.rate * (1 - math.sqrt((step - self.level + 1) / (self.steps - self.level + 1)))

    def average(self, averaged: Sequence[Tensor], current: Sequence[Tensor], count: Tensor | int) -> None:
        """Take a share of the current weights into the averaged ones."""
        kept = min(self.averaging, (1 + float(count)) / (10 + float(count)))
        for mine, new in zip(averaged, current, strict=True):
            mine.lerp_(new, 1 - kept) if mine.is_floating_point() else mine.copy_(new)


def train(
    task: Task,
    examples: Batches,
    schedule: Schedule,
    folder: Path,
    workers: int = 1,
    about: str = "",
    unseen: Batches | None = None,
) -> PixelShapeCNN:
    """Train the network of a task, or go on from the last checkpoint in `folder`; gives it with averaged weights.

    What a checkpoint is of, `about` and the layout, is kept in it: another training does not go on from there.

    Under ``torchrun`` each process takes its share of the batches, on a GPU of its own where there are some. The losses
    over time go to `folder`/curve.csv, those of the averaged network on the first batch of `unseen` examples to
    `folder`/unseen.csv.
    """
    team = Team.join()
    torch.manual_seed(examples.seed)
    folder.mkdir(parents=True, exist_ok=True)
    task.to(team.device, memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]
    averaged = AveragedModel(task, multi_avg_fn=schedule.average, use_buffers=True)
    learnt = [weight for weight in task.parameters() if weight.requires_grad]
    optimizer = torch.optim.AdamW(learnt, lr=schedule.rate, weight_decay=0.01, fused=True)
    parts = {"task": task, "averaged": averaged, "optimizer": optimizer}
    checkpoints = Checkpoints(folder, parts, about + task.network.layout.to_json())
    done, spent = checkpoints.resume(schedule.steps, schedule.level, team.device)
    shared = DistributedDataParallel(task, find_unused_parameters=task.partial) if team.size > 1 else task
    examples.start, examples.stride = done * team.size + team.rank, team.size
    ahead = 4 if workers else None
    loader = DataLoader(
        examples, batch_size=None, num_workers=workers, prefetch_factor=ahead, worker_init_fn=use_one_thread
    )
    batches = iter(loader)
    curves = [Curve(folder / name, [*task.columns], done) for name in _CURVES] if team.leads else []
    test = None if unseen is None else _on_device(unseen.numbered(0), team.device)

    task.train()
    began, recent = time.monotonic() - spent, []
    bar = tqdm(range(done, schedule.steps), initial=done, total=schedule.steps, unit="batch", disable=not team.leads)
    for step in bar:
        batch = _on_device(next(batches), team.device)
        loss, *told = shared(*batch)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        nn.utils.clip_grad_norm_(learnt, 5.0)
        for group in optimizer.param_groups:
            group["lr"] = schedule.rate_at(step)
        optimizer.step()
        averaged.update_parameters(task)
        recent = [*recent[-49:], [value.item() for value in told]]
        if not team.leads:
            continue
        now = step + 1
        if now % 50 == 0:
            means = np.mean(recent, axis=0).tolist()
            curves[0].add(now, time.monotonic() - began, means)
            bar.set_postfix(loss=" ".join(f"{mean:.3f}" for mean in means))
        if now % schedule.checkpoint == 0 or now in (schedule.level, schedule.steps):
            checkpoints.keep(now, time.monotonic() - began, schedule.steps, schedule.level)
            if test is not None:
                curves[1].add(now, time.monotonic() - began, _tested(averaged.module, test))
    task.load_state_dict(averaged.module.state_dict())
    return task.network.to("cpu").eval()


def _on_device(batch: Iterable[Any], device: torch.device) -> list[Tensor]:
    images, *others = (torch.as_tensor(values).to(device) for values in batch)
    layout = torch.channels_last if images.ndim == 4 else torch.contiguous_format
    return [images.to(torch.float32).contiguous(memory_format=layout), *others]


def _tested(task: nn.Module, batch: list[Tensor]) -> list[float]:
    """The losses of a task on a batch."""
    training = task.training
    task.eval()
    with torch.inference_mode():
        _, *told = task(*batch)
    task.train(training)
    return [value.item() for value in told]


def use_one_thread(_: int) -> None:
    """NumPy in a worker leaves the other cores to the network."""
    threadpool_limits(1)
