"""Trains the network of coarse reconstruction on portraits of known heads (section 3.1.3)."""

from __future__ import annotations

import math
import time
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.nn.utils import clip_grad_norm_
from torch.optim.swa_utils import AveragedModel
from tqdm import tqdm

from ..avatar.coarse import LANDMARK_MM, CoarseFitter, landmark_weights
from ..avatar.network import PortraitNetwork
from .checkpoint import Checkpoints
from .curve import Curve
from .network import Schedule
from .portrait_set import PortraitSet

_BEFORE_COLOURS = 200  # steps with landmarks and shape alone
_SHAPE = 68.0  # how many landmarks the known shape counts as
_COLUMNS = ("loss", "landmarks", "shape")


def train_portrait_network(
    portraits: PortraitSet,
    fitter: CoarseFitter,
    schedule: Schedule,
    folder: Path,
    channels: tuple[int, ...] | None = None,
    about: str = "",
) -> tuple[PortraitNetwork, list[float]]:
    """Minimise equation 3 over rendered portraits, whose shape is known as well; or go on from `folder`.

    Parameters
    ----------
    portraits : PortraitSet
    fitter : CoarseFitter
    schedule : Schedule
    folder : Path
        For checkpoints and curve.csv.
    channels : tuple of int, optional
        Of the network's stages.
    about : str
        What is trained: a checkpoint of something else is refused.

    Returns
    -------
    network : PortraitNetwork
        With averaged weights.
    told : list of float
        The loss of a portrait, the mean error of landmarks in pixels of 224, and that of the shape in millimetres, not
        aligned, as they were over the last batches; the course of all is in curve.csv.
    """
    torch.manual_seed(0)
    folder.mkdir(parents=True, exist_ok=True)
    network = PortraitNetwork(fitter.sizes, channels) if channels else PortraitNetwork(fitter.sizes)
    network = network.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]
    averaged = AveragedModel(network, multi_avg_fn=schedule.average, use_buffers=True)
    optimizer = torch.optim.AdamW(network.parameters(), lr=schedule.rate, weight_decay=0.01)
    parts = {"network": network, "averaged": averaged, "optimizer": optimizer}
    checkpoints = Checkpoints(folder, parts, f"{about}, {network.channels}, {len(portraits)} portraits")
    done, spent = checkpoints.resume(schedule.steps, schedule.level, torch.device("cpu"))
    curve, recent = Curve(folder / "curve.csv", list(_COLUMNS), done), []
    began = time.monotonic() - spent
    for step in (bar := tqdm(range(done, schedule.steps), initial=done, total=schedule.steps, unit="batch")):
        for group in optimizer.param_groups:
            group["lr"] = schedule.rate_at(step)
        loss, landmarks, shape = _losses(network, fitter, portraits, schedule.batch, step)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        clip_grad_norm_(network.parameters(), 5.0)
        optimizer.step()
        averaged.update_parameters(network)
        recent = [*recent[-19:], [loss.item(), landmarks, shape]]
        now = step + 1
        if now % 20 == 0:
            means = np.mean(recent, axis=0).tolist()
            curve.add(now, time.monotonic() - began, means)
            bar.set_postfix(loss=" ".join(f"{mean:.2f}" for mean in means))
        if now % schedule.checkpoint == 0 or now in (schedule.level, schedule.steps):
            checkpoints.keep(now, time.monotonic() - began, schedule.steps, schedule.level)
    told = np.mean(recent, axis=0).tolist() if recent else [math.nan] * len(_COLUMNS)
    network.load_state_dict(averaged.module.state_dict())
    return network.to(memory_format=torch.contiguous_format).eval(), told  # pyright: ignore[reportCallIssue]


def _losses(
    network: PortraitNetwork, fitter: CoarseFitter, portraits: PortraitSet, batch: int, step: int
) -> tuple[Tensor, float, float]:
    """The loss of a batch of portraits that no other step sees, and the mean errors of landmarks and shape."""
    random = np.random.default_rng([step, batch])
    numbers = np.sort(random.choice(len(portraits), batch, replace=len(portraits) < batch))
    images, heads, points = (
        torch.from_numpy(np.stack(values).astype(np.float32))
        for values in zip(*(portraits.varied(number, random) for number in numbers), strict=True)
    )
    pictures = (images / 255).permute(0, 3, 1, 2)  # channels last in memory, as the network is
    with torch.autocast("cpu", torch.bfloat16):
        raw = network.raw(pictures)
    unknowns = network.unknowns(raw.float())
    seen = torch.from_numpy(portraits.seen[numbers])
    weights = torch.from_numpy(landmark_weights().astype(np.float32))
    colours = seen if step >= _BEFORE_COLOURS else None
    loss = fitter.loss(unknowns, points, weights, pictures, heads[:, None], colours)
    true = {name: torch.from_numpy(getattr(portraits, name)[numbers]) for name in ("identity", "expression")}
    off = (fitter.points(unknowns) - fitter.points(true))[:, : fitter.skin_size]
    share = seen / seen.sum(dim=1, keepdim=True)
    loss = loss + 0.5 * _SHAPE * (off.square().sum(dim=2) * share).sum() / LANDMARK_MM**2
    landmarks = (fitter.landmarks(unknowns) - points).norm(dim=2).mean()
    return loss / batch / 68, float(landmarks), float((off.detach().norm(dim=2) * share).sum() / batch)
