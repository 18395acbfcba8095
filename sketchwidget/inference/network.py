"""PixelShapeCNN: a sketch's pixels and the shape of its lines to identity and expression weights (paper 4.3)."""

from __future__ import annotations

import copy
import json
from dataclasses import asdict, dataclass, replace
from itertools import pairwise

import torch
from torch import Tensor, nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

from .shape_code import DETAILS

IMAGE_SIZE = 256


@dataclass(frozen=True)
class Layout:
    """Sizes of a PixelShapeCNN, and which of its parts it has: all networks of the paper's Table 2 are layouts.

    Parameters
    ----------
    convolutions : str
        "residual" ones in a size for a CPU, "alexnet" as in the paper, or "none": a network of lines alone.
    channels : tuple of int
        Of each stage of residual convolutions; each stage after the first halves the resolution.
    blocks : tuple of int
        Residual blocks of each stage.
    bottleneck : int
        Channels that go from the last stage into the fully connected layer.
    hidden : int
        Neurons of the shared fully connected layer.
    branch : int
        Neurons of each fully connected layer of the branches.
    shape : int
        Neurons in each branch for the shape-level input; with 0 there is no such input.
    details : int
        Numbers of this input that hold, beside the coefficients of the lines, the details of their points; a last one
        then says if points were found by matching (1), or it is known which is which (0).
    joined : int
        Neurons of a layer behind that of the shape-level input and the branch; with 0 the output follows at once.
    branched : bool
        Whether identity and expression have a branch each, or one stack for both.
    """

    convolutions: str = "residual"
    channels: tuple[int, ...] = (32, 64, 128, 192)
    blocks: tuple[int, ...] = (0, 1, 3, 2)
    bottleneck: int = 40
    hidden: int = 640
    branch: int = 448
    shape: int = 512
    details: int = 0
    joined: int = 0
    branched: bool = True

    def __post_init__(self) -> None:
        if self.convolutions not in ("residual", "alexnet", "none"):
            raise ValueError(f"convolutions are residual, alexnet or none; given {self.convolutions!r}")
        if self.convolutions == "none" and not self.shape:
            raise ValueError("a network sees pixels or shape; this layout has neither")

    @property
    def answers(self) -> tuple[str, ...]:
        """What a network of this layout answers to: "pixels", "shape" (with the pixels, if it sees them), or both."""
        seen = () if self.convolutions == "none" else ("pixels",)
        return (*seen, "shape") if self.shape else seen

    def tiny(self) -> Layout:
        """The same parts in small, to see them run."""
        small = {name: getattr(TINY, name) for name in ("channels", "blocks", "bottleneck", "hidden", "branch")}
        return replace(self, **small, shape=min(self.shape, TINY.shape), joined=min(self.joined, TINY.shape))

    def to_json(self) -> str:
        """The layout as it is kept in a network's file."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> Layout:
        """The layout of a network's file."""
        sizes = json.loads(text)
        return cls(**sizes | {name: tuple(sizes[name]) for name in ("channels", "blocks")})


COMPACT = Layout(details=DETAILS, joined=352)
PAPER = Layout(convolutions="alexnet", hidden=4096, branch=1024)
TINY = Layout(channels=(8, 12, 16, 16), blocks=(0, 1, 1, 1), bottleneck=8, hidden=64, branch=48, shape=32)


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


class PixelShapeCNN(nn.Module):
    """Convolutions and a fully connected layer, a branch of three layers for identity and one of one for expression.

    The shape-level input has a layer of its own in each branch, joined to it before the output (Figure 7). Beside these
    outputs stand those of the pixels alone, so that the network answers before lines are named: the convolutions run
    once for both. Outputs are standardised weights: 0 is the mean, 1 a standard deviation.

    Parameters
    ----------
    identity_size, expression_size : int
        The shape-level input has as many coefficients, and with `Layout.details` these and one number more.
    layout : Layout

    Attributes
    ----------
    described : int
        Numbers of the shape-level input.
    """

    def __init__(self, identity_size: int, expression_size: int, layout: Layout = COMPACT) -> None:
        super().__init__()
        self.layout, self.sizes = layout, (identity_size, expression_size)
        coefficients = identity_size + expression_size
        self.described = coefficients + (layout.details + 1 if layout.details else 0)
        if layout.convolutions == "none":
            self.convolutions, width = None, self.described
        else:
            build = _alexnet if layout.convolutions == "alexnet" else _residual
            self.convolutions, width = build(layout)
        self.shared = nn.Sequential(nn.Linear(width, layout.hidden), nn.ReLU(inplace=True))
        self.branches = nn.ModuleList(
            _stack(layout.hidden, layout.branch, depth) for depth in ((3, 1) if layout.branched else (3,))
        )
        outputs = self.sizes if layout.branched else (coefficients,)
        self.outputs = nn.ModuleList(nn.Linear(layout.branch, size) for size in outputs)
        self.shape_layers = self.shape_outputs = None
        if self.convolutions is not None and layout.shape:
            self.shape_layers = nn.ModuleList(
                nn.Sequential(nn.Linear(self.described, layout.shape), nn.ReLU(inplace=True)) for _ in outputs
            )
            self.shape_outputs = nn.ModuleList(_output(layout, size) for size in outputs)

    def folded(self) -> PixelShapeCNN:
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

    def features(self, inputs: Tensor) -> list[Tensor]:
        """What each branch makes of images (b, 1, 256, 256) with ink as 1, or of lines if there are no convolutions."""
        seen = inputs[:, : self.described] if self.convolutions is None else self.convolutions(inputs).flatten(1)
        shared = self.shared(seen)
        return [branch(shared) for branch in self.branches]

    def from_pixels(self, features: list[Tensor]) -> tuple[Tensor, Tensor]:
        """Standardised identity (b, p) and expression (b, q) weights of the pixels alone."""
        return self._split([output(feature) for output, feature in zip(self.outputs, features, strict=True)])

    def with_shape(self, features: list[Tensor], lines: Tensor) -> tuple[Tensor, Tensor]:
        """The same of pixels and of lines together, as `ShapeModel.describe` has them (b, p + q + r + 1).

        A layout takes the first `described` of these numbers.

        Raises
        ------
        ValueError
            If the network's layout has no shape-level input.
        """
        if self.shape_layers is None or self.shape_outputs is None:
            raise ValueError("this network sees pixels only: its layout has no shape-level input")
        joined = [
            torch.cat([feature, layer(lines[:, : self.described])], dim=1)
            for feature, layer in zip(features, self.shape_layers, strict=True)
        ]
        return self._split([output(feature) for output, feature in zip(self.shape_outputs, joined, strict=True)])

    def forward(self, images: Tensor, lines: Tensor) -> list[tuple[Tensor, Tensor]]:
        """Identity and expression weights of each of the network's answers: of the pixels, and with the shape."""
        if self.convolutions is None:
            return [self.from_pixels(self.features(lines))]
        features = self.features(images)
        answers = [self.from_pixels(features)]
        return answers if self.shape_layers is None else [*answers, self.with_shape(features, lines)]

    def _split(self, outputs: list[Tensor]) -> tuple[Tensor, Tensor]:
        identity, expression = outputs if len(outputs) == 2 else outputs[0].split(self.sizes, dim=1)
        return identity, expression


def _residual(layout: Layout) -> tuple[nn.Sequential, int]:
    """Residual convolutions over 4 x 4 patches, and how many features they give."""
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
    grid = IMAGE_SIZE // 4 // 2 ** (len(layout.channels) - 1)
    stages += [nn.Conv2d(width, layout.bottleneck, 1), nn.ReLU(inplace=True)]
    return nn.Sequential(*stages), layout.bottleneck * grid**2


class LocalResponseNorm(nn.LocalResponseNorm):
    """The same for numbers of any precision: PyTorch has it for 32 bits alone."""

    def forward(self, features: Tensor) -> Tensor:
        """Features of the same shape and precision."""
        return super().forward(features.float()).to(features.dtype)


def _alexnet(_: Layout) -> tuple[nn.Sequential, int]:
    """The convolutions of Krizhevsky et al. 2012, for one channel, and how many features they give."""
    layers = nn.Sequential(
        nn.Conv2d(1, 96, 11, stride=4, padding=2),
        nn.ReLU(inplace=True),
        LocalResponseNorm(5, alpha=1e-4, beta=0.75, k=2.0),
        nn.MaxPool2d(3, stride=2),
        nn.Conv2d(96, 256, 5, padding=2, groups=2),
        nn.ReLU(inplace=True),
        LocalResponseNorm(5, alpha=1e-4, beta=0.75, k=2.0),
        nn.MaxPool2d(3, stride=2),
        nn.Conv2d(256, 384, 3, padding=1),
        nn.ReLU(inplace=True),
        nn.Conv2d(384, 384, 3, padding=1, groups=2),
        nn.ReLU(inplace=True),
        nn.Conv2d(384, 256, 3, padding=1, groups=2),
        nn.ReLU(inplace=True),
        nn.MaxPool2d(3, stride=2),
    )
    return layers, 256 * 7 * 7


def _output(layout: Layout, size: int) -> nn.Module:
    """What follows where the shape-level input has joined a branch."""
    if not layout.joined:
        return nn.Linear(layout.branch + layout.shape, size)
    return nn.Sequential(
        nn.Linear(layout.branch + layout.shape, layout.joined), nn.ReLU(inplace=True), nn.Linear(layout.joined, size)
    )


def _stack(width: int, neurons: int, depth: int) -> nn.Sequential:
    """As many fully connected layers one after the other."""
    sizes = [width, *[neurons] * depth]
    layers = [(nn.Linear(before, after), nn.ReLU(inplace=True)) for before, after in pairwise(sizes)]
    return nn.Sequential(*(layer for pair in layers for layer in pair))
