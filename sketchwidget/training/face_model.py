"""Builds the shipped face model: posed heads from a source, decomposed (paper 4.1 and 4.2)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from joblib import Parallel, delayed
from tqdm import tqdm

from ..database.posing import to_millimetres
from ..database.source import FaceSource
from ..face.decomposition import COMPONENTS, RANK, decompose
from ..face.model import FaceModel

_CHUNK = 50  # identities that a process poses in one go; each go sends it the source anew


def pose_heads(source: FaceSource, numbers: range, path: Path, jobs: int = 1) -> np.ndarray:
    """Identities in all expressions, (identities, expressions, n, 3), memory-mapped; kept at `path` once made."""
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished = path.with_suffix(".part.npy")
        np.save(unfinished, _posed(source, numbers, jobs))
        unfinished.rename(path)
    heads = np.load(path, mmap_mode="r")
    if len(heads) != len(numbers):
        raise ValueError(f"{path} holds {len(heads)} identities, not {len(numbers)}: remove it to build it anew")
    return heads


def _posed(source: FaceSource, numbers: range, jobs: int) -> np.ndarray:
    """Identities in all expressions, spread by joblib: (identities, expressions, n, 3) float32."""
    chunks = [numbers[start : start + _CHUNK] for start in range(0, len(numbers), _CHUNK)]
    done = Parallel(n_jobs=jobs, return_as="generator")(delayed(_chunk)(source, chunk) for chunk in chunks)
    posed = np.empty((len(numbers), len(source.expressions), source.template.coarse_count, 3), dtype=np.float32)
    bar = tqdm(total=len(numbers), desc="identities", unit="head")
    for start, heads in zip(range(0, len(numbers), _CHUNK), done, strict=True):
        posed[start : start + _CHUNK] = heads
        bar.update(min(_CHUNK, len(numbers) - start))
    bar.close()
    return posed


def _chunk(source: FaceSource, numbers: range) -> np.ndarray:
    return np.stack([source.heads(number) for number in numbers])


def model_frame(source: FaceSource, heads: np.ndarray) -> tuple[float, np.ndarray]:
    """Scale and origin (3,) that make the mean of posed heads (i, e, n, 3) at rest 200 mm high and centred."""
    neutral = source.expressions.index("neutral")
    return to_millimetres(source.template.subdivision @ heads[:, neutral].mean(axis=0), source.template)


def build_face_model(source: FaceSource, heads: np.ndarray, rank: tuple[int, int] = RANK) -> FaceModel:
    """The bilinear model of posed heads (identities, expressions, n, 3) in their own frame."""
    scale, origin = model_frame(source, heads)
    tensor = scale * (np.asarray(heads) - origin.astype(np.float32))
    bilinear = decompose(tensor.reshape(*tensor.shape[:2], -1).astype(np.float32), rank, COMPONENTS)
    return FaceModel(source.template, bilinear, list(source.expressions))
