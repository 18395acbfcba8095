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


@dataclass(frozen=True)
class LookedAt:
    """Examples, features of the branches in place of their images.

    Parameters
    ----------
    features : (m, f) float16 array
        Those of one branch after the other; (m, 0) where only the lines are known.
    shapes : (m, p + q + r + 1) float16 array
    codes : (m, k) float32 array
    poses : (m, q) float32 array
        As `Batch` has them.
    """

    features: np.ndarray
    shapes: np.ndarray
    codes: np.ndarray
    poses: np.ndarray

    @classmethod
    def by(cls, network: PixelShapeCNN | None, examples: Examples, batches: int, workers: int) -> LookedAt:
        """So many batches of examples, as a network sees them; without one, their lines alone."""
        if network is not None:
            network = network.folded().to(torch.bfloat16, memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]
        loader = DataLoader(
            examples, batch_size=None, num_workers=workers, worker_init_fn=use_one_thread if workers else None
        )
        parts: list[tuple[np.ndarray, ...]] = []
        with torch.inference_mode():
            for _, batch in zip(tqdm(range(batches), desc="drawings", unit="batch"), loader, strict=False):
                images, shapes, codes, poses, _ = (torch.as_tensor(values) for values in batch)
                features = torch.empty(len(images), 0)
                if network is not None:
                    features = torch.cat(network.features(images.to(torch.bfloat16)), dim=1)
                # Copies: what comes from a worker holds a file open each, and there are tens of thousands.
                kept = (features.half(), shapes.half(), codes.clone(), poses.clone())
                parts.append(tuple(values.numpy() for values in kept))
        return cls(*(np.concatenate(part) for part in zip(*parts, strict=True)))

    def some(self, count: int, random: np.random.Generator) -> tuple[np.ndarray, ...]:
        """Features, shapes, codes and poses of so many of them, float32."""
        rows = random.integers(len(self.codes), size=count)
        return tuple(getattr(self, field.name)[rows].astype(np.float32) for field in fields(self))

    def save(self, path: Path) -> None:
        """Write them to a file (.npz)."""
        keep(path, asdict(self))

    @classmethod
    def load(cls, path: Path) -> LookedAt:
        """Those of a file; raises as `sketchwidget.files.kept.kept` does."""
        return cls(**kept(path, (field.name for field in fields(cls))))


class Again(Batches):
    """Batches drawn at random, some of what was looked at, the others of lines alone, whose features are 0.

    Features tell more of the people that the network has learnt than they will of others: who always has them believes
    the lines too little. And lines alone cost a fifth, so that there can be many.

    Parameters
    ----------
    drawings, lines : LookedAt
    seen, alone : int
        Drawings and lines alone in each batch.
    seed : int
    """

    def __init__(self, drawings: LookedAt, lines: LookedAt, seen: int, alone: int, seed: int) -> None:
        super().__init__(seed)
        self._drawings, self._lines, self._seen, self._alone = drawings, lines, seen, alone

    def numbered(self, number: int) -> Batch:
        """Batch `number`."""
        random = np.random.default_rng([self.seed, number])
        features, *seen = self._drawings.some(self._seen, random)
        _, *alone = self._lines.some(self._alone, random)
        shapes, codes, poses = (np.concatenate(both) for both in zip(seen, alone, strict=True))
        features = np.pad(features, [(0, self._alone), (0, 0)])
        return Batch(features, shapes, codes, poses, np.full(len(codes), -1))
