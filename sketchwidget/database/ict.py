"""Faces from a clone of ICT-FaceKit: principal components of scans, and blend shapes named as ARKit's (MIT)."""

from __future__ import annotations

import json
import os
import warnings
from functools import cached_property
from importlib.resources import files
from pathlib import Path

import numpy as np

from ..face.template import PARTS
from .obj import read_obj, read_registered, unrefined_template
from .source import TransferredSource

_NEUTRAL, _INDICES = "generic_neutral_mesh.obj", "vertex_indices.json"
_LANDMARKS = "idx_to_landmark_verts"
_SIDES = {"Left": "_L", "Right": "_R"}  # how the recipes and how the files end


class ICTFaceKitSource(TransferredSource):
    """Heads drawn from ICT-FaceKit's space of identities, read from the files of a clone.

    An identity is the generic head plus its components, each with a normal weight: they are scaled by their standard
    deviation. Only the components and the blend shapes that are there are used.

    Parameters
    ----------
    path : str or path
        The clone, or the folder of its OBJ files, FaceXModel.

    Raises
    ------
    FileNotFoundError
        If the generic head, its landmarks, all identities or all blend shapes are missing.
    ValueError
        If the generic head or its landmarks are not those of ICT-FaceKit, or not to be read.

    Warns
    -----
    UserWarning
        If expressions have to do without some of their actions.

    References
    ----------
    Li et al., "Learning formation of physically-based face attributes", 2020.
    """

    name = "ict"

    def __init__(self, path: str | os.PathLike[str]) -> None:
        inner = Path(path) / "FaceXModel"
        self._folder = inner if inner.is_dir() else Path(path)
        self._identities = sorted(self._folder.glob("identity[0-9][0-9][0-9].obj"))
        missing = [name for name in (_NEUTRAL, _INDICES) if not (self._folder / name).is_file()]
        if missing or not self._identities:
            missing += [] if self._identities else ["identity000.obj"]
            raise FileNotFoundError(
                f"{self._folder} lacks {', '.join(missing)}: give the source 'ict' a clone of"
                " https://github.com/ICT-VGL/ICT-FaceKit"
            )
        head = json.loads(files("sketchwidget.database").joinpath("ict_head.json").read_text())
        self._generic = read_obj(self._folder / _NEUTRAL)
        if len(self._generic.vertices) != head["vertex_count"]:
            raise ValueError(
                f"{self._generic.path} has {len(self._generic.vertices):,} vertices; ICT-FaceKit's has"
                f" {head['vertex_count']:,}"
            )
        part_of = np.full(head["vertex_count"], len(PARTS), dtype=np.uint8)
        for part, ranges in head["parts"].items():
            for first, end in ranges:
                part_of[first:end] = PARTS.index(part)
        quads = _between(self._generic.quads, part_of < len(PARTS))
        try:
            landmarks = json.loads((self._folder / _INDICES).read_text())[_LANDMARKS]
            self.template, self._kept = unrefined_template(quads, part_of, head["curves"], landmarks)
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"{self._folder / _INDICES} has no 68 landmarks under {_LANDMARKS!r}: {error}") from error
        self._shapes, self._recipes = self._find_shapes()

    def identity(self, number: int) -> np.ndarray:
        """Vertices (n, 3), in centimetres, of identity `number` at rest; the same number gives the same face."""
        weights = np.random.default_rng([number, 2017]).normal(size=len(self._identities))
        return self._rest + np.tensordot(weights, self._components, axes=1)

    def poses(self) -> dict[str, np.ndarray]:
        """The generic head in every expression that the blend shapes allow, vertices (n, 3) by name."""
        shapes = {
            action: np.sum([self._displacement(file) for file in found], axis=0)
            for action, found in self._shapes.items()
        }
        return {
            name: self._rest + sum(weight * shapes[action] for action, weight in recipe.items())
            for name, recipe in self._recipes.items()
        }

    @cached_property
    def _rest(self) -> np.ndarray:
        return self._generic.vertices[self._kept]

    @cached_property
    def _components(self) -> np.ndarray:
        return np.stack([self._displacement(file).astype(np.float32) for file in self._identities])

    def _displacement(self, file: Path) -> np.ndarray:
        return read_registered(file, self._generic)[self._kept] - self._rest

    def _find_shapes(self) -> tuple[dict[str, list[Path]], dict[str, dict[str, float]]]:
        """Files of each action, and the recipes of what can be posed with them."""
        wanted = json.loads(files("sketchwidget.database").joinpath("expressions.json").read_text())
        actions = sorted({action for recipe in wanted.values() for action in recipe})
        shapes = {action: found for action in actions if (found := self._files(action))}
        recipes = {}
        for name, recipe in wanted.items():
            possible = {action: weight for action, weight in recipe.items() if action in shapes}
            if possible or not recipe:
                recipes[name] = possible
        missing = [action for action in actions if action not in shapes]
        if not shapes:
            raise FileNotFoundError(f"{self._folder} lacks the blend shapes of all expressions: {', '.join(missing)}")
        if missing:
            left_out = [name for name in wanted if name not in recipes]
            warnings.warn(
                f"{self._folder} lacks the blend shapes {', '.join(missing)}: expressions do without them"
                + (f", and {', '.join(left_out)} are left out" if left_out else ""),
                stacklevel=3,
            )
        return shapes, recipes

    def _files(self, action: str) -> list[Path]:
        """The blend shapes that make an action, one whole or one a side; none if one is missing."""
        names = [[action], [action + side for side in _SIDES.values()]]
        names += [[action.removesuffix(word) + side] for word, side in _SIDES.items() if action.endswith(word)]
        for choice in names:
            found = [self._folder / f"{name}.obj" for name in choice]
            if all(file.is_file() for file in found):
                return found
        return []


def _between(quads: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Faces (k, 4) between kept vertices; of a quad that loses one corner the triangle stays, so that rims are even."""
    inside = kept[quads]
    cut = inside.sum(axis=1) == 3
    behind_lost = (~inside[cut]).argmax(axis=1)[:, None] + [1, 2, 3, 3]
    return np.concatenate([quads[inside.all(axis=1)], np.take_along_axis(quads[cut], behind_lost % 4, axis=1)])
