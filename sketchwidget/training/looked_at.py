"""Drawings that a network has looked at: what its branches make of them, once, for the layers behind to see often."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
import torch
from torch.utils.data import DataLoader
from tqdm import tqdm

from ..files.kept import keep, kept
from ..inference.network import PixelShapeCNN
from .examples import Batch, Batches, Examples
from .network import use_one_thread

_UNSEEN = 0.5  # share of the drawings seen again whose pixels are not


@dataclass(frozen=True)
class LookedAt:
    """Examples, features of the branches in place of their images.

    Parameters
    ----------
    features : (m, f) float16 array
        Those of one branch after the other.
    shapes : (m, p + q + 2 n) float16 array
    codes : (m, k) float32 array
    poses : (m, q) float32 array
        As `Batch` has them.
    """

    features: np.ndarray
    shapes: np.ndarray
    codes: np.ndarray
    poses: np.ndarray

    @classmethod
    def by(cls, network: PixelShapeCNN, examples: Examples, batches: int, workers: int) -> LookedAt:
        """So many batches of examples, as a network sees them."""
        network = network.folded().to(torch.bfloat16, memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]
        loader = DataLoader(
            examples, batch_size=None, num_workers=workers, worker_init_fn=use_one_thread if workers else None
        )
        parts: list[tuple[np.ndarray, ...]] = []
        with torch.inference_mode():
            for _, batch in zip(tqdm(range(batches), desc="drawings", unit="batch"), loader, strict=False):
                images, shapes, codes, poses, _ = (torch.as_tensor(values) for values in batch)
                features = torch.cat(network.features(images.to(torch.bfloat16)), dim=1)
                parts.append((features.half().numpy(), shapes.half().numpy(), codes.numpy(), poses.numpy()))
        return cls(*(np.concatenate(part) for part in zip(*parts, strict=True)))

    def save(self, path: Path) -> None:
        """Write them to a file (.npz)."""
        keep(path, asdict(self))

    @classmethod
    def load(cls, path: Path) -> LookedAt:
        """Those of a file; raises as `sketchwidget.files.kept.kept` does."""
        return cls(**kept(path, (field.name for field in fields(cls))))


class Again(Batches):
    """Batches drawn at random of what was looked at, half of them without the pixels' features.

    These tell more of the people that the network has learnt than they will of others: who always has them believes
    the lines too little.

    Parameters
    ----------
    drawings : LookedAt
    batch : int
    seed : int
    """

    def __init__(self, drawings: LookedAt, batch: int, seed: int) -> None:
        super().__init__(seed)
        self._drawings, self._batch = drawings, batch

    def numbered(self, number: int) -> Batch:
        """Batch `number`."""
        drawings = self._drawings
        random = np.random.default_rng([self.seed, number])
        rows = random.integers(len(drawings.codes), size=self._batch)
        nobody = np.full(self._batch, -1)
        features, shapes = drawings.features[rows].astype(np.float32), drawings.shapes[rows].astype(np.float32)
        features[random.random(self._batch) < _UNSEEN] = 0.0
        return Batch(features, shapes, drawings.codes[rows], drawings.poses[rows], nobody)
