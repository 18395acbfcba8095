"""A stroke as one of the ten gestures, or none of them (DeepSketch2Face, section 5.2)."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Self

import numpy as np
import torch
from safetensors.torch import save_file

from ..files.shipped import shipped
from ..files.tensorfile import read, writing
from ..sketch.stroke import as_points
from ..threads import one_thread
from .names import GESTURES, LINE
from .network import GestureCNN
from .picture import picture

FORMAT = "sketchwidget gestures 1"
_REACHED = 0.7  # of the way from a line's start to what of it is farthest: hooks at its end are shorter


class GestureClassifier:
    """Tells the gestures apart by what a stroke looks like, whatever its place, its size and its first point.

    Parameters
    ----------
    network : GestureCNN
    threshold : float
        A stroke whose most probable gesture is less probable is none of the ten.

    Examples
    --------
    >>> turn = np.linspace(0, 2 * np.pi, 60)
    >>> name, probability = sw.GestureClassifier.load().classify(np.stack([np.cos(turn), np.sin(turn)], axis=1))
    >>> name
    'region'
    """

    def __init__(self, network: GestureCNN, threshold: float) -> None:
        self.network = network.eval()
        self.threshold = threshold

    def __repr__(self) -> str:
        return f"GestureClassifier(threshold={self.threshold:.2f})"

    def classify(self, points: Any) -> tuple[str | None, float]:
        """What gesture a stroke is.

        Parameters
        ----------
        points : (n, 2) array-like
            In any frame, y down, in the order they were drawn.

        Returns
        -------
        name : str or None
            One of `GESTURES`; None if it looks like none of them, is a dot, or is a line there and back.
        probability : float
            Of the most probable gesture.

        Raises
        ------
        ValueError
            If the points are no stroke.
        """
        stroke = as_points(points)
        if (stroke == stroke[0]).all():
            return None, 0.0
        with one_thread():
            probabilities = self.probabilities(picture(stroke)[None])[0]
        best = int(probabilities.argmax())
        probability = float(probabilities[best])
        name = GESTURES[best] if probability >= self.threshold else None
        return (None if name == LINE and _comes_back(stroke) else name), probability

    def probabilities(self, images: np.ndarray) -> np.ndarray:
        """Probability (b, 10) of each gesture, for images (b, 256, 256) bool of strokes, as `picture` makes them."""
        with torch.inference_mode():
            seen = torch.from_numpy(np.ascontiguousarray(images)).to(torch.float32)[:, None]
            return self.network(seen).softmax(dim=1).numpy()

    def save(self, path: str | os.PathLike[str], provenance: dict[str, str]) -> None:
        """Write the classifier, its weights in half precision, with where it came from in the header.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        tensors = {name: tensor.to(torch.float16).contiguous() for name, tensor in self.network.state_dict().items()}
        header = {"format": FORMAT, "threshold": repr(self.threshold), **provenance}
        with writing(path) as unfinished:
            save_file(tensors, unfinished, header)

    @classmethod
    def load(cls, path: str | os.PathLike[str] | None = None) -> Self:
        """Read a classifier; without a path, the shipped one.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ValueError
            If it is no classifier of gestures, is damaged, or is larger than 256 MB.
        """
        path = shipped("gestures.safetensors") if path is None else Path(path)
        header, tensors = read(path, "gesture classifier", FORMAT, "pt")
        network = GestureCNN()
        try:
            network.load_state_dict({name: tensor.to(torch.float32) for name, tensor in tensors.items()})
            return cls(network, float(header["threshold"]))
        except (KeyError, RuntimeError, ValueError) as error:
            raise ValueError(f"{path} is a damaged gesture classifier: {error}") from error


def _comes_back(stroke: np.ndarray) -> bool:
    """Whether a stroke ends well short of what of it is farthest from its start: it may look like a line."""
    away = np.linalg.norm(stroke - stroke[0], axis=1)
    return bool(away[-1] < _REACHED * away.max())
