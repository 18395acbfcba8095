"""Files of trained networks: weights, what standardises them, and the shape model, with where they came from."""

from __future__ import annotations

import os
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import save_file

from ..face import FaceModel
from ..files.tensorfile import read, writing
from .network import Layout, PixelShapeCNN
from .shape_code import ShapeModel

FORMAT = "sketchwidget network 3"
_FORMER = ("sketchwidget network 2",)  # lines were described in another way
_STANDARD = ("identity_mean", "identity_std", "expression_mean", "expression_std")
_SHAPE = "shape."
_SHAPE_FIELDS = tuple(field.name for field in fields(ShapeModel))
_HALVED = ("core", "detail_axes")


@dataclass(frozen=True)
class StoredNetwork:
    """What a file of a network holds.

    Parameters
    ----------
    header : dict of str
    network : PixelShapeCNN
    standard : dict of arrays
        Mean and standard deviation of its weights, see `FaceRegressor`.
    shape_model : ShapeModel
        Codes lines for its shape-level input.
    """

    header: dict[str, str]
    network: PixelShapeCNN
    standard: dict[str, np.ndarray]
    shape_model: ShapeModel


def read_network(path: Path) -> StoredNetwork:
    """The network of a file.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file is no network, is damaged, or larger than 256 MB.
    """
    header, tensors = read(path, "network", FORMAT, framework="pt")
    try:
        standard = {key: tensors.pop(key).numpy() for key in _STANDARD}
        shape_model = ShapeModel(**{key: tensors.pop(_SHAPE + key).float().numpy() for key in _SHAPE_FIELDS})
        sizes = len(standard["identity_mean"]), len(standard["expression_mean"])
        network = PixelShapeCNN(*sizes, Layout.from_json(header["layout"]))
        network.load_state_dict(tensors)
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        raise ValueError(f"{path} is a damaged network: {error}") from error
    return StoredNetwork(header, network, standard, shape_model)


def read_weights(path: Path) -> dict[str, torch.Tensor]:
    """The weights alone of a network's file, of this format or the former one; raises as `read_network` does."""
    _, tensors = read(path, "network", FORMAT, framework="pt", former=_FORMER)
    return {name: tensor for name, tensor in tensors.items() if name not in _STANDARD and not name.startswith(_SHAPE)}


def save_network(
    path: str | os.PathLike[str],
    network: PixelShapeCNN,
    standard: dict[str, np.ndarray],
    shape_model: ShapeModel,
    model: FaceModel,
    provenance: dict[str, str],
) -> None:
    """Write a trained network, its weights as bfloat16, with where it came from in the header."""
    tensors = {
        name: tensor.to(torch.bfloat16) if tensor.is_floating_point() else tensor
        for name, tensor in network.state_dict().items()
    }
    tensors |= {name: torch.from_numpy(standard[name]) for name in _STANDARD}
    for name in _SHAPE_FIELDS:
        kind = torch.float16 if name in _HALVED else torch.float32
        tensors[_SHAPE + name] = torch.from_numpy(getattr(shape_model, name)).to(kind)
    header = {"format": FORMAT, "layout": network.layout.to_json(), "face_model": model.fingerprint, **provenance}
    with writing(path) as unfinished:
        save_file({name: tensor.contiguous() for name, tensor in tensors.items()}, unfinished, header)
