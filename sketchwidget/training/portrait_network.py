"""Trains the network of coarse reconstruction on portraits of known heads (section 3.1.3)."""

from __future__ import annotations

import numpy as np
import torch
from tqdm import tqdm

from ..avatar.coarse import CoarseFitter, as_tensors, landmark_weights
from ..avatar.network import SIDE, PortraitNetwork
from ..avatar.stylize import cartoon
from ..avatar.template import AvatarTemplate
from ..face.model import FaceModel
from .portraits import KnownPortrait, render_portrait

_CARTOONS = 0.5  # share of the portraits that are drawn as cartoons first
_BEFORE_COLOURS = 0.3  # of the steps, with landmarks alone
_RATE = 1e-3


def train_portrait_network(
    model: FaceModel,
    template: AvatarTemplate,
    steps: int,
    batch: int,
    channels: tuple[int, ...] | None = None,
    variety: int | None = None,
) -> tuple[PortraitNetwork, list[float]]:
    """Minimise equation 3 over rendered portraits.

    Parameters
    ----------
    model : FaceModel
    template : AvatarTemplate
    steps, batch : int
    channels : tuple of int, optional
        Of the network's stages.
    variety : int, optional
        How many portraits there are; by default none is shown twice.

    Returns
    -------
    network : PortraitNetwork
    losses : list of float
        Mean landmark error of each batch, in pixels of 224.
    """
    torch.manual_seed(0)
    fitter = CoarseFitter(model, template)
    network = PortraitNetwork(fitter.sizes, channels) if channels else PortraitNetwork(fitter.sizes)
    optimiser = torch.optim.AdamW(network.parameters(), lr=_RATE)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, _RATE, total_steps=steps)
    weights = torch.from_numpy(landmark_weights().astype(np.float32))
    errors = []
    for step in tqdm(range(steps), unit="batch"):
        numbers = step * batch + np.arange(batch)
        portraits = [render_portrait(model, template, int(n % (variety or n + 1)), SIDE) for n in numbers]
        pictures = torch.cat([as_tensors(_drawn(portrait, step), portrait.mask)[0] for portrait in portraits])
        found = network(pictures)
        total, off = torch.zeros(()), []
        for k, portrait in enumerate(portraits):
            unknowns = {name: value[k] for name, value in found.items()}
            wanted = torch.from_numpy(portrait.landmarks.astype(np.float32))
            seen = fitter.visible(unknowns) if step >= _BEFORE_COLOURS * steps else torch.empty(0, dtype=torch.long)
            sure = torch.from_numpy(portrait.mask.astype(np.float32))[None, None]
            total = total + fitter.loss(unknowns, wanted, weights, pictures[k : k + 1], sure, seen)
            off.append(float((fitter.landmarks(unknowns) - wanted).norm(dim=1).mean()))
        optimiser.zero_grad()
        (total / batch).backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 50.0)
        optimiser.step()
        schedule.step()
        errors.append(float(np.mean(off)))
    return network.eval(), errors


def _drawn(portrait: KnownPortrait, seed: int) -> np.ndarray:
    """The picture, or now and then a cartoon of it."""
    if np.random.default_rng([seed, len(portrait.image)]).random() > _CARTOONS:
        return portrait.image
    return cartoon(portrait.image)
