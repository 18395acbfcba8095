"""The bilinear face model: identity and expression weights to a head."""

from __future__ import annotations

import hashlib
import json
import os
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from safetensors.numpy import save_file
from scipy.sparse.linalg import SuperLU, splu

from ..files.shipped import shipped
from ..files.tensorfile import read, writing
from ..geometry.finite import check_finite
from ..sketch import FEATURES, SILHOUETTE
from .appearance import vertex_colors
from .bilinear import Bilinear, fit
from .face import Face
from .handles import CurveHandles
from .template import Template
from .wrinkles import LIPS, Wrinkles

FORMAT = "sketchwidget face model 2"
_CURVE = "curve."


class FaceModel:
    """A family of heads with one topology, spanned by identity and expression weights (paper 4.2, equation 1).

    Parameters
    ----------
    template : Template
    bilinear : Bilinear
        On the coarse vertices.
    expressions : sequence of str
        Names of the expressions of the tensor, the resting face as "neutral".
    mean_identity : (p,) array, optional
        Weights of the identity that stands for all; by default the mean of the tensor's.

    Examples
    --------
    >>> model = sw.FaceModel.load()
    >>> model.identity_size, model.expression_size, len(model.expressions)
    (50, 16, 25)
    >>> somebody = model.bilinear.identities[7]
    >>> laugh = model.face(somebody, "laugh")
    >>> identity, expression = model.fit(laugh.vertices)  # backwards
    >>> bool(np.linalg.norm(model.face(identity, expression).vertices - laugh.vertices, axis=1).max() < 1)  # mm
    True
    """

    def __init__(
        self, template: Template, bilinear: Bilinear, expressions: list[str], mean_identity: np.ndarray | None = None
    ) -> None:
        if len(expressions) != len(bilinear.expressions) or "neutral" not in expressions:
            raise ValueError(
                f"a model names each of its {len(bilinear.expressions)} expressions, one of them 'neutral';"
                f" given {expressions}"
            )
        self.template = template
        self.bilinear = bilinear
        self.expressions = list(expressions)
        self.mean_identity = bilinear.identities.mean(axis=0) if mean_identity is None else mean_identity

    @property
    def identity_size(self) -> int:
        """Number of identity weights."""
        return self.bilinear.core.shape[1]

    @property
    def expression_size(self) -> int:
        """Number of expression weights."""
        return self.bilinear.core.shape[2]

    @property
    def faces(self) -> np.ndarray:
        """Triangles (F, 3) int32."""
        return self.template.faces

    @property
    def curves(self) -> dict[str, np.ndarray]:
        """Vertex indices (k,) int32 of the predefined curves, by line name."""
        return self.template.curves

    @property
    def landmarks(self) -> np.ndarray:
        """Vertex indices (68,) int32 of the landmarks, in iBUG order."""
        return self.template.landmarks

    @cached_property
    def mean(self) -> np.ndarray:
        """The mean face (V, 3): the mean identity at rest."""
        return self.face().vertices

    @cached_property
    def colors(self) -> np.ndarray:
        """Colour (V, 3) float32 of each vertex."""
        return vertex_colors(self.template, self.mean)

    @cached_property
    def wrinkles(self) -> Wrinkles:
        """What draws the wrinkles of this model's heads."""
        return Wrinkles(self.template, self.mean)

    @cached_property
    def handles(self) -> CurveHandles:
        """What deforms this model's heads by their lines; made when it is first asked for, in about a second."""
        return CurveHandles(self.template, self.mean)

    def vertices(self, identity: np.ndarray, expression: np.ndarray) -> np.ndarray:
        """Fine vertices (V, 3) float32 from weights; see `face`."""
        return self.template.subdivision @ self.coarse(identity, expression)

    def coarse(self, identity: np.ndarray, expression: np.ndarray) -> np.ndarray:
        """Coarse vertices (n, 3), millimetres, from weights: the mesh whose refinement is the head."""
        return self.bilinear.mesh(identity, expression).reshape(-1, 3)

    def face(self, identity: Any = None, expression: Any = None) -> Face:
        """The head with the given weights.

        Parameters
        ----------
        identity : (identity_size,) array, optional
            None is the mean identity.
        expression : (expression_size,) array or str, optional
            Weights, or the name of one of `expressions`; None is the face at rest.

        Raises
        ------
        ValueError
            If weights have another shape or are not finite, or no expression has that name.
        """
        u = self.mean_identity if identity is None else _weights(identity, self.identity_size, "identity")
        if expression is None or isinstance(expression, str):
            v = self.expression_weights("neutral" if expression is None else expression)
        else:
            v = _weights(expression, self.expression_size, "expression")
        return Face(self, self.vertices(u, v), u, v)

    def fit(self, vertices: Any) -> tuple[np.ndarray, np.ndarray]:
        """Weights of a given mesh: those of the model's face that is nearest to it.

        Parameters
        ----------
        vertices : (V, 3) array
            A mesh of this topology, in millimetres and in the model's frame.

        Returns
        -------
        identity : (identity_size,) float32 array
        expression : (expression_size,) float32 array

        Raises
        ------
        ValueError
            If the vertices have another shape or are not finite.
        """
        return fit(self.bilinear, self.nearest_coarse(vertices).ravel().astype(np.float32))

    def nearest_coarse(self, vertices: Any) -> np.ndarray:
        """The coarse mesh (n, 3) float64 whose refinement is nearest to a given one; parameters are those of `fit`."""
        given = np.asarray(vertices, dtype=np.float64)
        expected = (len(self.template.fine_parts), 3)
        check_finite(given, expected, f"a mesh of this model has finite vertices {expected}", "vertex")
        return self._normal_equations.solve(self.template.subdivision.astype(np.float64).T @ given)

    @property
    def fingerprint(self) -> str:
        """SHA-256 of the core, in hexadecimal: ties weights and networks to the model that they are for."""
        return hashlib.sha256(self.bilinear.core.tobytes()).hexdigest()

    @cached_property
    def _normal_equations(self) -> SuperLU:
        """Of the coarse mesh whose refinement is nearest to a fine one."""
        refine = self.template.subdivision.astype(np.float64)
        return splu((refine.T @ refine).tocsc())

    def __getstate__(self) -> dict[str, Any]:
        """What processes send each other: all but what holds factorisations, which cannot be pickled."""
        return {name: value for name, value in self.__dict__.items() if name not in ("_normal_equations", "handles")}

    def expression_weights(self, name: str) -> np.ndarray:
        """Weights (expression_size,) of one of `expressions`.

        Raises
        ------
        ValueError
            If no expression has that name.
        """
        if name not in self.expressions:
            raise ValueError(f"an expression is one of {', '.join(self.expressions)}; given {name!r}")
        return self.bilinear.expressions[self.expressions.index(name)]

    def save(self, path: str | os.PathLike[str], provenance: dict[str, str]) -> None:
        """Write the model to a safetensors file, its basis in half precision, with where it came from in the header.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        template, model = self.template, self.bilinear
        tensors = {
            "quads": template.quads.astype(np.int32),
            "parts": template.parts,
            "landmarks": template.landmarks,
            "mean": model.mean,
            "basis": model.basis.astype(np.float16),
            "core": model.core,
            "identities": model.identities,
            "expressions": model.expressions,
            "mean_identity": self.mean_identity,
            **{_CURVE + name: path for name, path in template.curves.items()},
        }
        header = {"format": FORMAT, "expressions": json.dumps(self.expressions), **provenance}
        if not template.refined:
            header["refined"] = "false"  # a header without the word is of a mesh that is refined
        with writing(path) as unfinished:
            save_file({name: np.ascontiguousarray(tensor) for name, tensor in tensors.items()}, unfinished, header)

    @classmethod
    def load(cls, path: str | os.PathLike[str] | None = None) -> FaceModel:
        """Read a model; without a path, the shipped one.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ValueError
            If it is no face model, is damaged, or is larger than 256 MB.
        """
        path = shipped("face.safetensors") if path is None else Path(path)
        header, tensors = read(path, "face model", FORMAT)
        try:
            return cls._from_tensors(tensors, json.loads(header["expressions"]), header.get("refined") != "false")
        except (KeyError, IndexError, ValueError) as error:
            raise ValueError(f"{path} is a damaged face model: {error}") from error

    @classmethod
    def _from_tensors(cls, tensors: dict[str, np.ndarray], expressions: list[str], refined: bool) -> FaceModel:
        curves = {name.removeprefix(_CURVE): tensors[name] for name in tensors if name.startswith(_CURVE)}
        template = Template(tensors["quads"], tensors["parts"], curves, tensors["landmarks"], refined)
        bilinear = Bilinear(
            mean=tensors["mean"],
            # Column by column, it is read in two thirds of the time when it has left the cache.
            basis=tensors["basis"].astype(np.float32, order="F"),
            core=tensors["core"],
            identities=tensors["identities"],
            expressions=tensors["expressions"],
        )
        model = cls(template, bilinear, expressions, tensors["mean_identity"])
        missing = {SILHOUETTE, *FEATURES, *LIPS} - set(curves)
        used = np.concatenate([template.landmarks, *curves.values()])
        if missing or used.min() < 0 or used.max() >= len(model.mean):
            raise ValueError(f"it lacks the curves {sorted(missing)}, or a landmark or curve is off the mesh")
        return model


def _weights(given: Any, size: int, mode: str) -> np.ndarray:
    weights = np.asarray(given, dtype=np.float32)
    if weights.shape != (size,) or not np.isfinite(weights).all():
        raise ValueError(f"{mode} weights are {size} finite numbers; given {given!r}")
    return weights
