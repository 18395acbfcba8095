"""From a drawing to a head: the networks at run time."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch

from ..face import Face, FaceModel
from ..face.drawing import outline as drawn_outline
from ..face.wrinkles import LIPS
from ..files.shipped import shipped
from ..geometry.view import CANVAS_MM, View
from ..sketch import FEATURES, SILHOUETTE, UNNAMED, Sketch
from ..threads import one_thread
from .framing import Frame, place
from .matching import DrawnLines, shape_code
from .naming import name_strokes
from .network import IMAGE_SIZE, PixelShapeCNN
from .network_file import read_network
from .normalise import Normalised, normalise
from .refinement import LineRefiner
from .resting import MouthAtRest, mouth_may_be_drawn
from .shape_code import ShapeModel
from .soft_limit import soft_limit

NETWORKS = ("PixelShapeCNN", "PixelCNN")  # one file: the second is the first without its shape-level input
_SHIPPED = "pixelshapecnn.safetensors"
_MOVED_BY_EARS = 1.5  # mm
BY_PIXELS = 0.3  # share of what pixels alone give in the answer by both: where lines are misnamed, they do not know
# Standard deviations that weights may go to freely, and at most: beyond, heads dent and eyes leave their lids.
_IDENTITY_LIMIT, _EXPRESSION_LIMIT = (2.0, 3.0), (2.5, 3.5)


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
    network : PixelShapeCNN
    standard : dict of arrays
        Mean and standard deviation of the weights that the network gives in standardised form: `identity_mean`,
        `identity_std` (p,), `expression_mean`, `expression_std` (q,).
    shape_model : ShapeModel, optional
        Codes the lines of a drawing for the network's shape-level input; without it only the pixels count.
    refine : bool
        Whether the lines that were named move the network's answer towards them; without that ears change nothing.
    database : str
        Sum of the database that the network was trained on.

    Examples
    --------
    >>> drawing = sw.FaceModel.load().face(expression="smile").sketch()
    >>> face = sw.FaceRegressor.load().predict(drawing)
    >>> bool(face.landmarks[54, 1] > face.landmarks[57, 1])  # a corner of the mouth is above the lower lip
    True
    """

    def __init__(
        self,
        model: FaceModel,
        network: PixelShapeCNN,
        standard: dict[str, np.ndarray],
        shape_model: ShapeModel | None = None,
        refine: bool = True,
        database: str = "",
    ) -> None:
        self.model, self.shape_model, self.database = model, shape_model, database
        self._lines, self._refines = LineRefiner(model, standard), refine
        self._network = network.folded().bfloat16()
        self._network.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]
        self._standard = standard
        self._landmarks = _basis_at(model, model.landmarks)
        self._at_rest = MouthAtRest(model, self._landmarks, standard["expression_std"])
        on_curves = np.concatenate(list(model.curves.values()))
        self._curve_mean = model.template.subdivision[on_curves] @ model.bilinear.mean.reshape(-1, 3)
        self._curve_basis = _basis_at(model, on_curves)

    @property
    def sees(self) -> tuple[str, ...]:
        """What the network takes in: "pixels", "shape" or both."""
        layout = self._network.layout
        return ("pixels",) * (layout.convolutions != "none") + ("shape",) * (self.shape_model is not None)

    def predict(self, sketch: Sketch) -> Face:
        """The head that a drawing shows; an empty one shows the mean face. Raises as `infer` does."""
        return self.infer(sketch).face

    def infer(self, sketch: Sketch) -> Inference:
        """The head that a drawing shows, where it stands on the canvas, and what each stroke is.

        Once an outline of the head is found, place and size are taken from it, and strokes that are outside it and no
        ears are left out: the same drawing moved or scaled gives the same head, and hair moves nothing. Before that the
        canvas itself is the frame. Where lines refine the head, ears beside the outline shape its ears and hardly
        anything else. Within an outline a mouth that nobody has drawn is at rest.

        Raises
        ------
        TypeError
            If the drawing is no `Sketch`.
        """
        if not isinstance(sketch, Sketch):
            raise TypeError(f"a drawing is a Sketch, as Sketch.from_strokes makes; given {type(sketch).__name__}")
        with one_thread("blas"):
            return self._infer(sketch)

    def _infer(self, sketch: Sketch) -> Inference:
        began = time.perf_counter()
        strokes = [segment.points for segment in sketch.segments]
        seen = normalise(strokes)
        drawn = time.perf_counter()
        features = self._features(seen)
        identity, expression = (None, None) if features is None else self._weights(features)
        inferred = time.perf_counter()
        view, names, named = View(), tuple(segment.name for segment in sketch.segments), inferred
        if features is not None and identity is not None and expression is not None and seen.outline is not None:
            curves = self._curves(identity, expression)
            silhouette = drawn_outline(View().project(curves[SILHOUETTE]))
            view = place(silhouette, seen.outline.points)
            if UNNAMED in names:
                lines = {name: view.project(curves[name]) for name in (*FEATURES, *LIPS)}
                guessed = name_strokes(strokes, seen.outline, lines, seen.places)
                names = tuple(new if old == UNNAMED else old for old, new in zip(names, guessed, strict=True))
            named = time.perf_counter()
            frame = Frame.of_outline(silhouette)
            points = self._lines.framed(identity, expression)
            strokes = [frame(_on_head(view, stroke)) for stroke in strokes]
            identity, expression = self._by_lines(identity, expression, features, points, DrawnLines(strokes, names))
            if not mouth_may_be_drawn(strokes, names, seen.places, points):
                expression = self._at_rest(identity, expression)
        moved = time.perf_counter()
        face = self.model.face(identity, expression)
        if seen.outline is not None:
            view = place(drawn_outline(View().project(face.curve(SILHOUETTE))), seen.outline.points)
        moments = {
            "rasterising": drawn - began,
            "inference": inferred - drawn,
            "naming": named - inferred,
            "lines": moved - named,
            "mesh": time.perf_counter() - moved,
        }
        return Inference(face, view, names, {step: 1000 * seconds for step, seconds in moments.items()})

    def _curves(self, identity: np.ndarray, expression: np.ndarray) -> dict[str, np.ndarray]:
        """Points (k, 3) of the predefined curves of a head, without its mesh."""
        model = self.model
        points = self._curve_mean + (self._curve_basis @ (model.bilinear.core @ expression @ identity)).reshape(-1, 3)
        pieces = np.split(points, np.cumsum([len(path) for path in model.curves.values()])[:-1])
        return dict(zip(model.curves, pieces, strict=True))

    def _by_lines(
        self,
        identity: np.ndarray,
        expression: np.ndarray,
        features: list[torch.Tensor],
        lines: np.ndarray,
        drawn: DrawnLines,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weights again, now that strokes have names, from those of the pixels alone.

        The lines of the head (n, 2) and the drawn ones are in the frame of the head's outline: a drawn one may be open.
        """
        face = drawn.without_ears()
        if self.shape_model is not None:
            joined = self._weights(features, shape_code(self.shape_model, lines, face))
            identity, expression = (
                BY_PIXELS * alone + (1 - BY_PIXELS) * both
                for alone, both in zip((identity, expression), joined, strict=True)
            )
        if self._refines:
            identity, expression = self._limited(*self._lines(identity, expression, face.match))
            if ears := drawn.ears():
                identity = self._with_ears(identity, expression, ears)
        return identity, expression

    def _with_ears(self, identity: np.ndarray, expression: np.ndarray, ears: DrawnLines) -> np.ndarray:
        """Identity weights nearer to drawn ears, as far as they leave the landmarks where they are but for 1.5 mm."""
        moved, _ = self._limited(*self._lines(identity, expression, ears.match))
        # Landmarks are linear in the identity, so that a share of the change moves them by that share.
        change = moved - identity
        moves = (self._landmarks @ (self.model.bilinear.core @ expression @ change)).reshape(-1, 3)
        farthest = float(np.linalg.norm(moves, axis=1).max())
        return identity + min(1.0, _MOVED_BY_EARS / max(farthest, 1e-9)) * change

    def _features(self, seen: Normalised) -> list[torch.Tensor] | None:
        """What the branches make of a drawing without its ears."""
        if self._network.convolutions is None:
            raise ValueError("this network sees lines only, and a drawing's lines are found by one that sees pixels")
        if not seen.face.any():
            return None
        pixels = torch.from_numpy(seen.face.view(np.uint8))  # six times as fast to convert as bools
        with torch.inference_mode():
            return self._network.features(pixels[None, None].to(torch.bfloat16))

    def _weights(self, features: list[torch.Tensor], code: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Weights of one drawing."""
        identities, expressions = self._answers(features, None if code is None else code[None])
        return identities[0], expressions[0]

    def weights(self, images: np.ndarray, codes: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Identity and expression weights of normalised sketches.

        Parameters
        ----------
        images : (b, 256, 256) bool array
        codes : (b, p + q + r + 1) array, optional
            Of their lines, as `ShapeModel.describe` has them, or `shape_code` where it is not known which point is
            which; without it only the pixels count.

        Returns
        -------
        identity : (b, p) float32 array
        expression : (b, q) float32 array

        Raises
        ------
        ValueError
            If images or codes have another shape or type, or there are no codes and the network sees nothing else.
        """
        seen = images if self._network.convolutions is not None else codes
        if seen is None and self._network.convolutions is None:
            raise ValueError("this network sees lines only: give it their codes")
        if seen is images and not (_is_array(images, 3, np.bool_) and images.shape[1:] == (IMAGE_SIZE, IMAGE_SIZE)):
            raise ValueError(f"images are bool arrays (b, {IMAGE_SIZE}, {IMAGE_SIZE}); given {_about(images)}")
        wanted = self._network.described
        if codes is not None and not (_is_array(codes, 2, np.floating) and codes.shape[1] >= wanted):
            raise ValueError(f"codes of lines are arrays (b, {wanted}) or longer of numbers; given {_about(codes)}")
        with torch.inference_mode():
            inputs = torch.from_numpy(seen)
            features = self._network.features((inputs[:, None] if inputs.ndim == 3 else inputs).to(torch.bfloat16))
        return self._answers(features, codes if self._network.shape_layers is not None else None)

    def _answers(self, features: list[torch.Tensor], codes: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        with torch.inference_mode():
            if codes is None:
                outputs = self._network.from_pixels(features)
            else:
                outputs = self._network.with_shape(features, torch.from_numpy(codes).to(torch.bfloat16))
            identity, expression = (output.float().numpy() for output in outputs)
        standard = self._standard
        return self._limited(
            standard["identity_mean"] + standard["identity_std"] * identity,
            standard["expression_mean"] + standard["expression_std"] * expression,
        )

    def _limited(self, identity: np.ndarray, expression: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights (..., p) and (..., q) that go no further from the mean than heads can."""
        limited = []
        for mode, weights, limits in (
            ("identity", identity, _IDENTITY_LIMIT),
            ("expression", expression, _EXPRESSION_LIMIT),
        ):
            mean, std = self._standard[f"{mode}_mean"], self._standard[f"{mode}_std"]
            limited.append(mean + std * soft_limit((weights - mean) / std, *limits))
        return limited[0], limited[1]

    @classmethod
    def load(cls, name: str | Path | None = None, model: FaceModel | None = None, refine: bool = True) -> FaceRegressor:
        """A shipped network by name ("PixelShapeCNN", the default, or "PixelCNN"), or one from a file by its path.

        Parameters
        ----------
        name : str or Path, optional
        model : FaceModel, optional
            The model that it was trained for; the shipped one by default.
        refine : bool
            Whether the lines that were named move the network's answer towards them.

        Raises
        ------
        TypeError
            If an argument is of another type.
        FileNotFoundError
            If no such network ships and there is no such file.
        ValueError
            If the file is no network, is damaged, larger than 256 MB, or was trained for another face model.
        """
        name = NETWORKS[0] if name is None else name
        if not isinstance(name, str | Path) or not isinstance(model, FaceModel | None) or not isinstance(refine, bool):
            raise TypeError(
                "a network is loaded by its name or path, with a FaceModel, and refine is true or false; given "
                f"{name!r}, {model!r}, {refine!r}"
            )
        path = shipped(_SHIPPED) if name in NETWORKS else Path(name)
        if not path.is_file():
            raise FileNotFoundError(f"no network {name!r}: it is one of {', '.join(NETWORKS)}, or the path of a file")
        model = model or FaceModel.load()
        stored = read_network(path)
        if stored.header.get("face_model") != model.fingerprint:
            raise ValueError(f"{path} was trained for another face model; train it anew, or give the model it is for")
        pixels_only = name == "PixelCNN" or not stored.network.layout.shape
        shape_model = None if pixels_only else stored.shape_model
        return cls(model, stored.network, stored.standard, shape_model, refine, stored.header.get("database", ""))


def _is_array(values: object, dimensions: int, kind: type[np.generic]) -> bool:
    return isinstance(values, np.ndarray) and values.ndim == dimensions and np.issubdtype(values.dtype, kind)


def _about(values: object) -> str:
    return f"{values.dtype} {values.shape}" if isinstance(values, np.ndarray) else repr(values)


def _basis_at(model: FaceModel, vertices: np.ndarray) -> np.ndarray:
    """The basis (3 k, m) of the coordinates of some vertices (k,) of the fine mesh."""
    pick = model.template.subdivision[vertices]
    by_vertex = model.bilinear.basis.reshape(-1, 3, model.bilinear.basis.shape[1])
    return np.stack([pick @ by_vertex[:, axis] for axis in range(3)], axis=1).reshape(3 * len(vertices), -1)


def _on_head(view: View, points: np.ndarray) -> np.ndarray:
    """Canvas points of a drawing in which a head stands in a front view, where it stands in the canonical one."""
    return (points - view.centre) / (view.scale * CANVAS_MM) + 0.5
