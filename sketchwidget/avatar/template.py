"""What every avatar starts from: expressions of the template head, its texture chart, and how skin is coloured."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from safetensors.numpy import save_file

from ..face.model import FaceModel
from ..files.shipped import shipped
from ..files.tensorfile import read, writing

FORMAT = "sketchwidget avatar template 1"


@dataclass(frozen=True, eq=False)
class AvatarTemplate:
    """Expressions, chart and albedo of a template head, on the coarse vertices (n) of a face model.

    Parameters
    ----------
    quads : (m, 4) int array
        The coarse mesh that it is for.
    neutral : (n, 3) array
        The template head at rest, millimetres: ``S_0`` of the paper.
    actions : dict of (n, 3) arrays
        What each expression moves of it, by ARKit's name: ``S_i - S_0``, section 3.3.
    chart : (n, 2) array
        Texture coordinates between 0 and 1, v upwards; every vertex has one place, and no triangle is turned over.
    albedo : (n, 3) array
        Mean colour of each vertex, 0 to 1: ``T`` of equation 2.
    albedo_basis : (k, n, 3) array
        Its variation, each scaled to a standard deviation: ``A_tex``.
    scalp : (n,) array
        How much each vertex is where hair grows on most heads, 0 to 1.
    """

    quads: np.ndarray
    neutral: np.ndarray
    actions: dict[str, np.ndarray]
    chart: np.ndarray
    albedo: np.ndarray
    albedo_basis: np.ndarray
    scalp: np.ndarray

    @classmethod
    def load(cls, path: str | os.PathLike[str] | None = None) -> AvatarTemplate:
        """Read a template; without a path, the shipped one.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ValueError
            If it is none, or damaged.
        """
        path = shipped("avatar.safetensors") if path is None else Path(path)
        header, tensors = read(path, "avatar template", FORMAT)
        try:
            names = json.loads(header["actions"])
            return cls(
                quads=tensors["quads"],
                neutral=tensors["neutral"],
                actions=dict(zip(names, tensors["actions"].astype(np.float32), strict=True)),
                chart=tensors["chart"],
                albedo=tensors["albedo"],
                albedo_basis=tensors["albedo_basis"].astype(np.float32),
                scalp=tensors["scalp"],
            )
        except (KeyError, ValueError) as error:
            raise ValueError(f"{path} is a damaged avatar template: {error}") from error

    def save(self, path: str | os.PathLike[str], provenance: dict[str, str]) -> None:
        """Write the template, with where it came from in the header; displacements in half precision."""
        tensors = {
            "quads": self.quads.astype(np.int32),
            "neutral": self.neutral.astype(np.float32),
            "actions": np.stack(list(self.actions.values())).astype(np.float16),
            "chart": self.chart.astype(np.float32),
            "albedo": self.albedo.astype(np.float32),
            "albedo_basis": self.albedo_basis.astype(np.float16),
            "scalp": self.scalp.astype(np.float32),
        }
        header = {"format": FORMAT, "actions": json.dumps(list(self.actions)), **provenance}
        with writing(path) as unfinished:
            save_file(tensors, unfinished, header)

    def check(self, model: FaceModel) -> None:
        """Raise a ValueError unless the template is for heads of this model."""
        if not np.array_equal(self.quads, model.template.quads):
            raise ValueError(
                "the avatar template is for another topology than the face model's: avatars are built with the shipped"
                " model, or with a template made for yours"
            )

    @cached_property
    def action_names(self) -> tuple[str, ...]:
        """ARKit's names of the expressions, in order."""
        return tuple(self.actions)
