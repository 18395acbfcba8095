"""The network of coarse reconstruction: a picture to model coefficients, light and pose (section 3.1.2)."""

from __future__ import annotations

import json
import os
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import torch
from safetensors.torch import save_file
from torch import Tensor, nn

from ..face.model import FaceModel
from ..files.shipped import shipped
from ..files.tensorfile import read, writing
from .coarse import USUAL_LIGHT, CoarseFit, CoarseFitter

FORMAT = "sketchwidget portrait network 1"
SIDE = 224
_CHANNELS = (16, 32, 64, 128, 256)  # each stage halves the resolution
_GRID, _FEATURES = 7, 32  # places a side, and what of each: a mean over all of them would not tell where things are
_FACE = 0.62  # of the picture's side: how high a face 200 mm high usually is in it
_LIGHT, _TURN, _SCALE, _SHIFT = 0.3, 0.25, 0.15, 0.6  # what an output of 1 means, by unknown


class PortraitNetwork(nn.Module):
    """A residual network in a size for a CPU, from a square picture of a face to the unknowns of `CoarseFitter.loss`.

    Parameters
    ----------
    sizes : dict of int
        How many numbers each unknown is, as `CoarseFitter.sizes` has them.
    channels : tuple of int
        Of the stages.
    """

    def __init__(self, sizes: dict[str, int], channels: tuple[int, ...] = _CHANNELS) -> None:
        super().__init__()
        self.sizes, self.channels = dict(sizes), tuple(channels)
        self.stem = nn.Sequential(
            nn.Conv2d(3, channels[0], 5, 2, 2, bias=False), nn.BatchNorm2d(channels[0]), nn.ReLU()
        )
        self.stages = nn.Sequential(*(_Block(below, here) for below, here in pairwise(channels)))
        self.places = nn.Sequential(nn.AdaptiveAvgPool2d(_GRID), nn.Conv2d(channels[-1], _FEATURES, 1))
        self.head = nn.Linear(_FEATURES * _GRID**2, sum(sizes.values()))
        nn.init.normal_(self.head.weight, std=1e-3)
        nn.init.zeros_(self.head.bias)

    def forward(self, pictures: Tensor) -> dict[str, Tensor]:
        """Unknowns (b, ...) by name, in pixels of the pictures (b, 3, 224, 224), 0 to 1."""
        return self.unknowns(self.raw(pictures))

    def raw(self, pictures: Tensor) -> Tensor:
        """What `unknowns` makes unknowns of: (b, sum of the sizes)."""
        return self.head(self.places(self.stages(self.stem(2 * pictures - 1))).relu().flatten(1))

    def unknowns(self, raw: Tensor) -> dict[str, Tensor]:
        """Unknowns (b, ...) by name."""
        unknowns = dict(zip(self.sizes, raw.split(list(self.sizes.values()), dim=1), strict=True))
        scale = np.log(_FACE * SIDE / 200)
        unknowns["light"] = raw.new_tensor(USUAL_LIGHT) + _LIGHT * unknowns["light"]
        unknowns["turn"] = _TURN * unknowns["turn"]
        unknowns["scale"] = scale + _SCALE * unknowns["scale"][:, 0]
        middle = SIDE / 2 / np.exp(scale) / 10  # centimetres
        unknowns["shift"] = middle + _SHIFT * unknowns["shift"]
        return unknowns

    def predict(self, square: np.ndarray, fitter: CoarseFitter) -> CoarseFit:
        """The first guess for a square picture (S, S, 3) uint8 of a face, in its pixels."""
        small = cv2.resize(square, (SIDE, SIDE), interpolation=cv2.INTER_AREA)
        picture = torch.from_numpy(small.transpose(2, 0, 1)[None].astype(np.float32) / 255)
        with torch.no_grad():
            unknowns = {name: value[0] for name, value in self(picture).items()}
        unknowns["scale"] = unknowns["scale"] + float(np.log(len(square) / SIDE))
        return fitter.result(unknowns)

    def save(self, path: str | os.PathLike[str], model: FaceModel, provenance: dict[str, str]) -> None:
        """Write the network in half precision to a safetensors file; its header has the face model that it is for."""
        header = {"format": FORMAT, "sizes": json.dumps(self.sizes), "channels": json.dumps(self.channels)}
        state = {name: value.contiguous() for name, value in self.state_dict().items()}
        with writing(path) as unfinished:
            save_file(
                {name: value.half() if value.is_floating_point() else value for name, value in state.items()},
                unfinished,
                header | {"model": model.fingerprint} | provenance,
            )

    @classmethod
    def load(cls, model: FaceModel, path: str | os.PathLike[str] | None = None) -> PortraitNetwork:
        """Read a network for a face model; without a path, the shipped one.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ValueError
            If it is none, is damaged, or is for another face model.
        """
        path = shipped("portrait.safetensors") if path is None else Path(path)
        header, tensors = read(path, "portrait network", FORMAT, "pt")
        if header.get("model") != model.fingerprint:
            raise ValueError(
                f"{path} is for another face model; train one for yours with `sketchwidget train portraits`"
            )
        try:
            network = cls(json.loads(header["sizes"]), tuple(json.loads(header["channels"])))
            network.load_state_dict(tensors)
        except (KeyError, ValueError, RuntimeError) as error:
            raise ValueError(f"{path} is a damaged portrait network: {error}") from error
        return network.eval()


class _Block(nn.Module):
    """Two convolutions past which a picture of half the size goes straight on."""

    def __init__(self, below: int, here: int) -> None:
        super().__init__()
        self.one = nn.Sequential(nn.Conv2d(below, here, 3, 2, 1, bias=False), nn.BatchNorm2d(here), nn.ReLU())
        self.two = nn.Sequential(nn.Conv2d(here, here, 3, 1, 1, bias=False), nn.BatchNorm2d(here))
        self.past = nn.Sequential(nn.AvgPool2d(2, ceil_mode=True), nn.Conv2d(below, here, 1, bias=False))

    def forward(self, x: Tensor) -> Tensor:
        return torch.relu(self.two(self.one(x)) + self.past(x))
