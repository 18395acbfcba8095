"""PixelCNN: a sketch's pixels to identity and expression weights (paper 4.3)."""

from __future__ import annotations

import copy
import json
from dataclasses import asdict, dataclass

import torch
from torch import Tensor, nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

IMAGE_SIZE = 256


@dataclass(frozen=True)
class Layout:
    """Sizes of a PixelCNN.

    Parameters
    ----------
    channels : tuple of int
        Of each stage of convolutions; each stage after the first halves the resolution.
    blocks : tuple of int
        Residual blocks of each stage.
    bottleneck : int
        Channels that go into the fully connected layer, on an 8 x 8 grid.
    hidden : int
        Neurons of the shared fully connected layer.
    branch : int
        Neurons of each fully connected layer of the branches.
    """

    channels: tuple[int, ...] = (32, 64, 128, 192)
    blocks: tuple[int, ...] = (0, 2, 3, 2)
    bottleneck: int = 40
    hidden: int = 640
    branch: int = 448

    def to_json(self) -> str:
        """The layout as it is kept in a network's file."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> Layout:
        """The layout of a network's file."""
        sizes = json.loads(text)
        return cls(**sizes | {name: tuple(sizes[name]) for name in ("channels", "blocks")})


COMPACT = Layout()
TINY = Layout(channels=(8, 12, 16, 16), blocks=(0, 1, 1, 1), bottleneck=8, hidden=64, branch=48)


class Residual(nn.Module):
    """Two 3 x 3 convolutions beside the identity."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.body = nn.Sequential(
            nn.Conv2d(channels, channels, 3, padding=1, bias=False),
            nn.BatchNorm2d(channels),
            nn.ReLU(inplace=True),
            nn.Conv2d(channels, channels, 3, padding=1, bias=False),
            nn.BatchNorm2d(channels),
        )

    def forward(self, features: Tensor) -> Tensor:
        """Features of the same shape."""
        return torch.relu(features + self.body(features))


class PixelCNN(nn.Module):
    """Shared convolutions and a fully connected layer, then a branch of three layers for identity and of one for
    expression.

    The convolutions are residual ones rather than AlexNet's, in a size for a CPU; everything after them is as in
    Figure 7. Outputs are standardised weights: 0 is the mean, 1 a standard deviation.

    Parameters
    ----------
    identity_size, expression_size : int
    layout : Layout
    """

    def __init__(self, identity_size: int, expression_size: int, layout: Layout = COMPACT) -> None:
        super().__init__()
        stages: list[nn.Module] = [nn.PixelUnshuffle(4)]
        width = 16
        for stage, (channels, blocks) in enumerate(zip(layout.channels, layout.blocks, strict=True)):
            stages += [
                nn.Conv2d(width, channels, 3, stride=1 if stage == 0 else 2, padding=1, bias=False),
                nn.BatchNorm2d(channels),
                nn.ReLU(inplace=True),
                *(Residual(channels) for _ in range(blocks)),
            ]
            width = channels
        self.convolutions = nn.Sequential(*stages, nn.Conv2d(width, layout.bottleneck, 1), nn.ReLU(inplace=True))
        grid = IMAGE_SIZE // 4 // 2 ** (len(layout.channels) - 1)
        self.shared = nn.Sequential(nn.Linear(layout.bottleneck * grid**2, layout.hidden), nn.ReLU(inplace=True))
        self.identity = nn.Sequential(
            nn.Linear(layout.hidden, layout.branch),
            nn.ReLU(inplace=True),
            nn.Linear(layout.branch, layout.branch),
            nn.ReLU(inplace=True),
            nn.Linear(layout.branch, layout.branch),
            nn.ReLU(inplace=True),
            nn.Linear(layout.branch, identity_size),
        )
        self.expression = nn.Sequential(
            nn.Linear(layout.hidden, layout.branch), nn.ReLU(inplace=True), nn.Linear(layout.branch, expression_size)
        )

    def folded(self) -> PixelCNN:
        """The same network for inference only, each batch normalisation folded into the convolution before it."""
        network = copy.deepcopy(self).eval()
        for layers in network.modules():
            if isinstance(layers, nn.Sequential):
                for place in range(len(layers) - 1):
                    convolution, normalisation = layers[place], layers[place + 1]
                    if isinstance(convolution, nn.Conv2d) and isinstance(normalisation, nn.BatchNorm2d):
                        layers[place] = fuse_conv_bn_eval(convolution, normalisation)
                        layers[place + 1] = nn.Identity()
        return network

    def forward(self, images: Tensor) -> tuple[Tensor, Tensor]:
        """Standardised identity (b, p) and expression (b, q) weights of images (b, 1, 256, 256) with ink as 1."""
        features = self.shared(self.convolutions(images).flatten(1))
        return self.identity(features), self.expression(features)
