"""From a drawing to a head: the networks at run time."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import save_file
from threadpoolctl import ThreadpoolController

from ..face import Face, FaceModel
from ..face.drawing import outline as drawn_outline
from ..face.tensorfile import read, writing
from ..geometry.view import View
from ..sketch import FEATURES, SILHOUETTE, UNNAMED, Sketch
from .framing import place
from .naming import name_strokes
from .network import Layout, PixelCNN
from .normalise import normalise
from .outline import Outline

FORMAT = "sketchwidget network 1"
NETWORKS = {"PixelCNN": "pixelcnn.safetensors"}
_MOVED_BY_EARS = 1.5  # mm
# Standard deviations that weights may go to freely, and at most: beyond, heads dent and eyes leave their lids.
_IDENTITY_LIMIT, _EXPRESSION_LIMIT = (3.0, 5.0), (2.5, 3.5)
_STANDARD = ("identity_mean", "identity_std", "expression_mean", "expression_std")


@dataclass(frozen=True)
class Inference:
    """What a drawing gave.

    Parameters
    ----------
    face : Face
    frame : View
        The front view in which the head stands where the drawing is.
    names : tuple of str
        A line name for each segment of the sketch.
    timings : dict of float
        Milliseconds by step.
    """

    face: Face
    frame: View
    names: tuple[str, ...]
    timings: dict[str, float] = field(default_factory=dict)


class FaceRegressor:
    """A trained network and the face model that it was trained for.

    Parameters
    ----------
    model : FaceModel
    network : PixelCNN
    standard : dict of arrays
        Mean and standard deviation of the weights that the network gives in standardised form: `identity_mean`,
        `identity_std` (p,), `expression_mean`, `expression_std` (q,).
    """

    def __init__(self, model: FaceModel, network: PixelCNN, standard: dict[str, np.ndarray]) -> None:
        self.model = model
        self._network = network.folded().bfloat16()
        self._network.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]
        self._standard = standard
        self._pools = ThreadpoolController()
        corners = model.template.subdivision[model.landmarks].toarray()  # (68, n)
        by_vertex = model.bilinear.basis.reshape(-1, 3, model.bilinear.basis.shape[1])
        self._landmarks = np.einsum("ln,nck->lck", corners, by_vertex).reshape(3 * len(corners), -1)

    def predict(self, sketch: Sketch) -> Face:
        """The head that a drawing shows; an empty one shows the mean face. Raises as `infer` does."""
        return self.infer(sketch).face

    def infer(self, sketch: Sketch) -> Inference:
        """The head that a drawing shows, where it stands on the canvas, and what each stroke is.

        Once an outline of the head is found, place and size are taken from it, and strokes that are outside it and no
        ears are left out: the same drawing moved or scaled gives the same head, and hair moves nothing. Before that the
        canvas itself is the frame. Ears beside the outline shape the head's ears and hardly anything else.

        Raises
        ------
        TypeError
            If the drawing is no `Sketch`.
        """
        if not isinstance(sketch, Sketch):
            raise TypeError(f"a drawing is a Sketch, as Sketch.from_strokes makes; given {type(sketch).__name__}")
        # NumPy's threads and torch's make each other wait, for tens of milliseconds; what NumPy does here is small.
        with self._pools.limit(limits=1, user_api="blas"):
            return self._infer(sketch)

    def _infer(self, sketch: Sketch) -> Inference:
        began = time.perf_counter()
        seen = normalise([segment.points for segment in sketch.segments])
        drawn = time.perf_counter()
        identity, expression = self._weights(seen.face, seen.ears)
        inferred = time.perf_counter()
        face = self.model.face(identity, expression)
        meshed = time.perf_counter()
        view, names = self._find(face, sketch, seen.outline, seen.places)
        moments = {
            "rasterising": drawn - began,
            "inference": inferred - drawn,
            "mesh": meshed - inferred,
            "naming": time.perf_counter() - meshed,
        }
        return Inference(face, view, names, {step: 1000 * seconds for step, seconds in moments.items()})

    def _weights(self, face_only: np.ndarray, ears: np.ndarray) -> tuple[np.ndarray | None, np.ndarray | None]:
        """Weights of a drawing whose ears (256, 256) may change the identity, but its landmarks only by 1.5 mm."""
        if not face_only.any():
            return None, None
        if not ears.any():
            identity, expression = self.weights(face_only[None])
            return identity[0], expression[0]
        identities, expressions = self.weights(np.stack([face_only, face_only | ears]))
        # Landmarks are linear in the identity, so that a share of the change moves them by that share.
        change = identities[1] - identities[0]
        moves = (self._landmarks @ (self.model.bilinear.core @ expressions[0] @ change)).reshape(-1, 3)
        farthest = float(np.linalg.norm(moves, axis=1).max())
        return identities[0] + min(1.0, _MOVED_BY_EARS / max(farthest, 1e-9)) * change, expressions[0]

    def _find(
        self, face: Face, sketch: Sketch, outline: Outline | None, places: list[str]
    ) -> tuple[View, tuple[str, ...]]:
        """Where a head stands on the canvas, and a name for each stroke."""
        named = tuple(segment.name for segment in sketch.segments)
        if outline is None:
            return View(), named
        view = place(drawn_outline(View().project(face.curve(SILHOUETTE))), outline.points)
        lines = {name: view.project(face.curve(name)) for name in FEATURES}
        guessed = name_strokes([segment.points for segment in sketch.segments], outline, lines, places)
        return view, tuple(new if old == UNNAMED else old for old, new in zip(named, guessed, strict=True))

    def weights(self, images: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Identity (b, p) and expression (b, q) weights of normalised sketch images (b, 256, 256) bool."""
        with torch.inference_mode():
            pixels = torch.from_numpy(images)[:, None].to(torch.bfloat16)
            identity, expression = (output.float().numpy() for output in self._network(pixels))
        standard = self._standard
        return (
            standard["identity_mean"] + standard["identity_std"] * soft_limit(identity, *_IDENTITY_LIMIT),
            standard["expression_mean"] + standard["expression_std"] * soft_limit(expression, *_EXPRESSION_LIMIT),
        )

    @classmethod
    def load(cls, name: str | None = None, model: FaceModel | None = None) -> FaceRegressor:
        """A shipped network by name ("PixelCNN", the default), or one from a file by its path.

        Parameters
        ----------
        name : str, optional
        model : FaceModel, optional
            The model that it was trained for; the shipped one by default.

        Raises
        ------
        FileNotFoundError
            If no such network ships and there is no such file.
        ValueError
            If the file is no network, is damaged, larger than 256 MB, or was trained for another face model.
        """
        name = name or "PixelCNN"
        path = Path(str(files("sketchwidget") / "data" / NETWORKS[name])) if name in NETWORKS else Path(name)
        if not path.is_file():
            raise FileNotFoundError(f"no network {name!r}: it is one of {', '.join(NETWORKS)}, or the path of a file")
        header, tensors = read(path, "network", FORMAT, framework="pt")
        model = model or FaceModel.load()
        if header.get("face_model") != model.fingerprint:
            raise ValueError(f"{path} was trained for another face model; train it anew, or give the model it is for")
        try:
            standard = {key: tensors.pop(key).numpy() for key in _STANDARD}
            network = PixelCNN(model.identity_size, model.expression_size, Layout.from_json(header["layout"]))
            network.load_state_dict(tensors)
        except (KeyError, TypeError, ValueError, RuntimeError) as error:
            raise ValueError(f"{path} is a damaged network: {error}") from error
        return cls(model, network, standard)


def soft_limit(values: np.ndarray, free: float, most: float) -> np.ndarray:
    """Values as they are up to `free` on both sides, then bent smoothly so that none is beyond `most`."""
    excess = np.maximum(np.abs(values) - free, 0)
    bent = (most - free) * np.tanh(excess / (most - free))
    return np.sign(values) * (np.minimum(np.abs(values), free) + bent)


def save_network(
    path: str | os.PathLike[str],
    network: PixelCNN,
    layout: Layout,
    standard: dict[str, np.ndarray],
    model: FaceModel,
    provenance: dict[str, str],
) -> None:
    """Write a trained network, its weights as bfloat16, with where it came from in the header."""
    tensors = {
        name: tensor.to(torch.bfloat16) if tensor.is_floating_point() else tensor
        for name, tensor in network.state_dict().items()
    }
    tensors |= {name: torch.from_numpy(standard[name]) for name in _STANDARD}
    header = {"format": FORMAT, "layout": layout.to_json(), "face_model": model.fingerprint, **provenance}
    with writing(Path(path)):
        save_file({name: tensor.contiguous() for name, tensor in tensors.items()}, path, header)
