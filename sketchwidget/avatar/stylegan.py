"""StyleGAN2 generators and the swapping of their layers: cartoons for who has checkpoints (section 3, stylization).

No weights ship. Parameters have the names of rosinality's *stylegan2-pytorch*, the form that most checkpoints are in.
"""

from __future__ import annotations

import os
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from ..files import torchfile

MAX_BYTES = 2**30
_SLOPE, _GAIN = 0.2, 2**0.5
_BLUR = (1.0, 3.0, 3.0, 1.0)
_MAPPING_RATE = 0.01  # learning-rate multiplier of the mapping network, part of its scale
_STEPS, _RATE, _NEAR_MEAN = 200, 0.05, 0.02


class Generator(nn.Module):
    """The StyleGAN2 generator, with the sizes that a checkpoint has.

    Parameters
    ----------
    style : int
        Size of the latent codes.
    mapping : int
        Layers of the mapping network.
    channels : list of int
        At resolutions 4, 8, 16, ...

    References
    ----------
    Karras, Laine, Aittala, Hellsten, Lehtinen and Aila, "Analyzing and improving the image quality of StyleGAN", 2020.
    """

    def __init__(self, style: int, mapping: int, channels: list[int]) -> None:
        super().__init__()
        self.size = 4 * 2 ** (len(channels) - 1)
        self.codes, self._code_size = 2 * len(channels), style
        layers = [_Linear(style, style, _MAPPING_RATE, active=True) for _ in range(mapping)]
        self.style = nn.Sequential(_PixelNorm(), *layers)
        self.input = _Constant(channels[0])
        self.conv1 = _Styled(channels[0], channels[0], style, False)
        self.to_rgb1 = _ToRgb(channels[0], style, False)
        self.convs, self.to_rgbs = nn.ModuleList(), nn.ModuleList()
        for below, here in pairwise(channels):
            self.convs += [_Styled(below, here, style, True), _Styled(here, here, style, False)]
            self.to_rgbs.append(_ToRgb(here, style, True))
        self.noises = nn.Module()
        for layer in range(2 * len(channels) - 1):
            side = 4 * 2 ** ((layer + 1) // 2)
            self.noises.register_buffer(f"noise_{layer}", torch.zeros(1, 1, side, side))

    def forward(self, codes: Tensor) -> Tensor:
        """Pictures (b, 3, size, size), about -1 to 1, of codes (b, `codes`, style) of the space W+."""
        noises = [getattr(self.noises, f"noise_{layer}") for layer in range(len(self.convs) + 1)]
        features = self.conv1(self.input(len(codes)), codes[:, 0], noises[0])
        picture = self.to_rgb1(features, codes[:, 1], None)
        for level, to_rgb in enumerate(self.to_rgbs):
            for layer in (2 * level, 2 * level + 1):
                features = self.convs[layer](features, codes[:, layer + 1], noises[layer + 1])
            picture = to_rgb(features, codes[:, 2 * level + 3], picture)
        return picture

    def mean_code(self, samples: int = 1024) -> Tensor:
        """Mean (style,) of what the mapping network makes of random codes; the same at every call."""
        random = torch.Generator().manual_seed(0)
        with torch.no_grad():
            return self.style(torch.randn(samples, self._code_size, generator=random)).mean(dim=0)

    @classmethod
    def of(cls, state: dict[str, Tensor]) -> Generator:
        """The generator of a state dict, loaded strictly.

        Raises
        ------
        ValueError
            If it is no state dict of one.
        """
        try:
            mapping = len([name for name in state if re.fullmatch(r"style\.\d+\.weight", name)])
            channels = [state["input.input"].shape[1]]
            levels = len([name for name in state if re.fullmatch(r"to_rgbs\.\d+\.bias", name)])
            channels += [state[f"convs.{2 * level}.conv.weight"].shape[1] for level in range(levels)]
            generator = cls(state["style.1.weight"].shape[0], mapping, channels)
            generator.load_state_dict(state, strict=True)
        except (KeyError, RuntimeError, IndexError) as error:
            raise ValueError(f"this is no StyleGAN2 generator in rosinality's form: {error}") from error
        return generator.eval()


def load_generator(path: str | os.PathLike[str]) -> dict[str, Tensor]:
    """The state dict of a generator from a ``.pt`` or ``.safetensors`` file; nothing is executed.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is larger than 1 GB, is a pickle that may run code, or holds no generator.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"there is no checkpoint at {path}")
    if path.stat().st_size > MAX_BYTES:
        raise ValueError(f"{path} is larger than the {MAX_BYTES >> 20} MB that a generator may have")
    if path.suffix == ".pkl":
        raise ValueError(
            f"{path} is a pickle, which may run code when it is read: convert it in a place that you trust with"
            " stylegan2-pytorch's convert_weight.py, and give the .pt file"
        )
    if path.suffix == ".safetensors":
        from safetensors import SafetensorError
        from safetensors.torch import load_file

        try:
            return load_file(path)
        except SafetensorError as error:
            raise ValueError(f"{path} is no safetensors file that can be read: {error}") from error
    read = torchfile.read(path)
    state = read.get("g_ema", read) if isinstance(read, dict) else read
    if not isinstance(state, dict) or not all(isinstance(value, Tensor) for value in state.values()):
        raise ValueError(f"{path} holds no generator: its tensors are looked for under 'g_ema'")
    return state


def swap_layers(base: dict[str, Tensor], other: dict[str, Tensor], resolution: int) -> dict[str, Tensor]:
    """A generator with the coarse layers of one model and the fine ones, and the mapping, of another.

    With `base` trained on photographs and `other` the same network trained on with cartoons, shapes are a cartoon's
    and surfaces a photograph's; a resolution as large as the pictures takes all of the cartoon.

    Parameters
    ----------
    base, other : dict of tensors
        State dicts of one architecture.
    resolution : int
        Layers up to this one come from `other`.

    Raises
    ------
    ValueError
        If the two are of different sizes, or the resolution is none of theirs.

    References
    ----------
    Pinkney and Adler, "Resolution dependent GAN interpolation for controllable image synthesis between domains", 2020.
    """
    if base.keys() != other.keys() or any(base[name].shape != other[name].shape for name in base):
        raise ValueError("layers are swapped between generators of one size; these two differ")
    resolutions = sorted({_resolution(name) for name in base} - {0})
    if resolution not in resolutions:
        raise ValueError(f"a resolution is one of {resolutions}; given {resolution}")
    return {name: other[name] if 0 < _resolution(name) <= resolution else base[name] for name in base}


def _resolution(name: str) -> int:
    """The resolution that a parameter works at; 0 for the mapping network."""
    if name.startswith("style."):
        return 0
    number = re.match(r"(convs|to_rgbs|noises)\.(?:noise_)?(\d+)", name)
    if number is None:
        return 4
    kind, index = number[1], int(number[2])
    return {"convs": 8 * 2 ** (index // 2), "to_rgbs": 8 * 2**index, "noises": 4 * 2 ** ((index + 1) // 2)}[kind]


def project(generator: Generator, image: np.ndarray, steps: int = _STEPS) -> Tensor:
    """Codes (`codes`, style) whose picture is near a given one, by optimisation from the mean code.

    Pictures are compared at every scale of a pyramid, since one that is shifted by a pixel is not far off.

    Parameters
    ----------
    generator : Generator
    image : (H, W, 3) uint8 array
    steps : int
    """
    wanted = torch.from_numpy(image.astype(np.float32)).permute(2, 0, 1)[None] / 127.5 - 1
    wanted = functional.interpolate(wanted, (generator.size,) * 2, mode="area")
    mean = generator.mean_code()
    codes = mean.expand(1, generator.codes, -1).clone().requires_grad_()
    optimiser = torch.optim.Adam([codes], lr=_RATE)
    for step in range(steps):
        for group in optimiser.param_groups:
            group["lr"] = _RATE * min(1.0, 4 * (1 - step / steps))
        optimiser.zero_grad()
        loss = _NEAR_MEAN * (codes - mean).square().mean()
        made, given = generator(codes), wanted
        while True:
            loss = loss + functional.smooth_l1_loss(made, given)
            if made.shape[-1] <= 8:
                break
            made, given = functional.avg_pool2d(made, 2), functional.avg_pool2d(given, 2)
        loss.backward()
        optimiser.step()
    return codes.detach()[0]


def picture(generator: Generator, codes: Tensor) -> np.ndarray:
    """The picture (size, size, 3) uint8 of codes (`codes`, style)."""
    with torch.no_grad():
        made = generator(codes[None])[0].permute(1, 2, 0).clamp(-1, 1)
    return np.rint((made.numpy() + 1) * 127.5).astype(np.uint8)


class _PixelNorm(nn.Module):
    def forward(self, x: Tensor) -> Tensor:
        return x * torch.rsqrt(x.square().mean(dim=1, keepdim=True) + 1e-8)


class _Linear(nn.Module):
    """A dense layer whose weights are scaled when it runs."""

    def __init__(self, size_in: int, size_out: int, rate: float = 1.0, active: bool = False, bias: float = 0.0) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.randn(size_out, size_in) / rate)
        self.bias = nn.Parameter(torch.full((size_out,), bias))
        self._scale, self._rate, self._active = rate / size_in**0.5, rate, active

    def forward(self, x: Tensor) -> Tensor:
        x = functional.linear(x, self.weight * self._scale, self.bias * self._rate)
        return _activated(x) if self._active else x


class _Constant(nn.Module):
    def __init__(self, channels: int) -> None:
        super().__init__()
        self.input = nn.Parameter(torch.randn(1, channels, 4, 4))

    def forward(self, batch: int) -> Tensor:
        return self.input.expand(batch, -1, -1, -1)


class _Kernel(nn.Module):
    """The blur that goes with doubling a picture."""

    kernel: Tensor

    def __init__(self) -> None:
        super().__init__()
        row = torch.tensor(_BLUR)
        self.register_buffer("kernel", 4 * torch.outer(row, row) / row.sum() ** 2)

    def forward(self, x: Tensor) -> Tensor:
        kernel = self.kernel.flip(0, 1).expand(x.shape[1], 1, -1, -1)
        return functional.conv2d(x, kernel, groups=x.shape[1])


class _Modulated(nn.Module):
    """A convolution whose weights a code scales, and normalises."""

    def __init__(self, channels_in: int, channels_out: int, kernel: int, style: int, up: bool, normal: bool) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.randn(1, channels_out, channels_in, kernel, kernel))
        self.modulation = _Linear(style, channels_in, bias=1.0)
        self.blur: _Kernel | None = _Kernel() if up else None
        self._normal, self._scale = normal, 1 / (channels_in * kernel**2) ** 0.5

    def forward(self, x: Tensor, code: Tensor) -> Tensor:
        batch, channels, height, width = x.shape
        weight = self._scale * self.weight * self.modulation(code)[:, None, :, None, None]
        if self._normal:
            weight = weight * torch.rsqrt(weight.square().sum(dim=(2, 3, 4), keepdim=True) + 1e-8)
        x = x.reshape(1, batch * channels, height, width)
        if self.blur is not None:
            weight = weight.transpose(1, 2).flatten(0, 1)
            x = functional.conv_transpose2d(x, weight, stride=2, groups=batch)
            x = x.reshape(batch, -1, *x.shape[2:])
            return self.blur(functional.pad(x, (1, 1, 1, 1)))
        x = functional.conv2d(x, weight.flatten(0, 1), padding=weight.shape[-1] // 2, groups=batch)
        return x.reshape(batch, -1, height, width)


class _Noise(nn.Module):
    def __init__(self) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.zeros(1))

    def forward(self, x: Tensor, noise: Tensor) -> Tensor:
        return x + self.weight * noise


class _Bias(nn.Module):
    def __init__(self, channels: int) -> None:
        super().__init__()
        self.bias = nn.Parameter(torch.zeros(channels))

    def forward(self, x: Tensor) -> Tensor:
        return _activated(x + self.bias[:, None, None])


class _Styled(nn.Module):
    def __init__(self, channels_in: int, channels_out: int, style: int, up: bool) -> None:
        super().__init__()
        self.conv = _Modulated(channels_in, channels_out, 3, style, up, normal=True)
        self.noise, self.activate = _Noise(), _Bias(channels_out)

    def forward(self, x: Tensor, code: Tensor, noise: Tensor) -> Tensor:
        return self.activate(self.noise(self.conv(x, code), noise))


class _ToRgb(nn.Module):
    def __init__(self, channels: int, style: int, up: bool) -> None:
        super().__init__()
        if up:
            self.upsample = _Kernel()
        self.conv = _Modulated(channels, 3, 1, style, up=False, normal=False)
        self.bias = nn.Parameter(torch.zeros(1, 3, 1, 1))

    def forward(self, x: Tensor, code: Tensor, below: Tensor | None) -> Tensor:
        picture = self.conv(x, code) + self.bias
        if below is None:
            return picture
        doubled = below.new_zeros(*below.shape[:2], 2 * below.shape[2], 2 * below.shape[3])
        doubled[..., ::2, ::2] = below
        return picture + self.upsample(functional.pad(doubled, (2, 1, 2, 1)))


def _activated(x: Tensor) -> Tensor:
    return _GAIN * functional.leaky_relu(x, _SLOPE)
