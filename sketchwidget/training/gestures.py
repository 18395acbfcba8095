"""Trains the classifier of pen gestures on simulated writers, and measures it on others (paper 5.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional
from tqdm import tqdm

from ..gesture.classifier import GestureClassifier
from ..gesture.names import GESTURES
from ..gesture.network import GestureCNN
from ..gesture.others import other
from ..gesture.picture import picture
from ..gesture.recordings import Recording
from ..gesture.writers import Writer

# Numbers of writers: none is among two of these.
TRAINING, CALIBRATION, HELD_OUT = range(2_000), range(2_000, 2_200), range(3_000, 3_200)

NONE = -1  # the label of what is no gesture

_RATE = 2e-3  # the highest learning rate
_OTHERS = 0.45  # of a batch is no gesture
_RECORDED = 0.25  # of a batch is recorded, if there are recordings
_REFUSED = 0.012  # of the gestures of calibration: how the threshold is chosen

Sample = tuple[np.ndarray, int]  # a stroke and the number of its gesture


@dataclass(frozen=True)
class Measured:
    """What a classifier makes of strokes that it should know.

    Parameters
    ----------
    confusion : (11, 11) int array
        How many strokes of each gesture (row) were taken for each (column); the last of both is none of the ten.
    """

    confusion: np.ndarray

    @property
    def accuracy(self) -> float:
        """Share of the gestures that were taken for what they are; one that is refused is not."""
        return float(np.trace(self.confusion[:-1, :-1]) / self.confusion[:-1].sum())

    @property
    def refused(self) -> float:
        """Share of the gestures that were refused."""
        return float(self.confusion[:-1, -1].sum() / self.confusion[:-1].sum())

    @property
    def false_acceptance(self) -> float:
        """Share of the strokes that are no gesture, yet were taken for one."""
        return float(self.confusion[-1, :-1].sum() / self.confusion[-1].sum())


def train(steps: int = 4_000, batch: int = 64, seed: int = 7, recordings: Sequence[Sample] = ()) -> GestureClassifier:
    """Train a classifier on simulated writers and, if there are some, on recorded strokes.

    What is no gesture is trained to look like each of the ten alike (outlier exposure: Hendrycks, Mazeika and
    Dietterich 2019), so that the network keeps the paper's layers, with one output a gesture. The threshold refuses
    twelve in a thousand gestures of writers who are met neither in training nor in measuring.
    """
    torch.manual_seed(seed)
    random = np.random.default_rng(seed)
    network = GestureCNN()
    network.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]
    optimizer = torch.optim.AdamW(network.parameters(), lr=_RATE, weight_decay=0.01)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, _RATE, total_steps=steps, pct_start=0.1)
    bar = tqdm(range(steps), unit="batch")
    for step in bar:
        images, labels = _as_batch(_batch(batch, random, recordings))
        with torch.autocast("cpu", torch.bfloat16):
            logits = network(images)
        loss = _loss(logits.float(), labels)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        optimizer.step()
        schedule.step()
        if step % 20 == 0:
            bar.set_postfix(loss=f"{loss.item():.3f}")
    classifier = GestureClassifier(network, 0.0)
    samples = simulate(CALIBRATION, max(1, min(200, steps // 10)), seed)
    images = np.stack([picture(stroke) for stroke, _ in samples])
    classifier.threshold = float(np.quantile(classifier.probabilities(images).max(axis=1), _REFUSED))
    return classifier


def simulate(writers: range, each: int, seed: int) -> list[Sample]:
    """Strokes of simulated writers, `each` of every gesture, from one writer after the other."""
    random = np.random.default_rng([seed, 1])
    return [
        (Writer.random(writers[number % len(writers)]).draw(name, random), label)
        for number in range(each)
        for label, name in enumerate(GESTURES)
    ]


def simulate_others(writers: range, count: int, seed: int) -> list[Sample]:
    """As many strokes of simulated writers that are no gestures."""
    random = np.random.default_rng([seed, 2])
    return [(other(Writer.random(writers[number % len(writers)]), random), NONE) for number in range(count)]


def as_sample(recording: Recording) -> Sample:
    """A recorded stroke, to train on."""
    return recording.points[:, :2], NONE if recording.name is None else GESTURES.index(recording.name)


def measure(classifier: GestureClassifier, samples: Sequence[Sample]) -> Measured:
    """What a classifier makes of strokes, and what it should."""
    confusion = np.zeros((len(GESTURES) + 1,) * 2, dtype=np.int64)
    for stroke, label in samples:
        name, _ = classifier.classify(stroke)
        confusion[label, NONE if name is None else GESTURES.index(name)] += 1
    return Measured(confusion)


def _batch(size: int, random: np.random.Generator, recordings: Sequence[Sample]) -> list[Sample]:
    samples: list[Sample] = []
    for place in random.random(size):
        writer = Writer.random(int(random.choice(TRAINING)))
        if place < _OTHERS:
            samples.append((other(writer, random), NONE))
        elif recordings and place > 1 - _RECORDED:
            samples.append(recordings[int(random.integers(len(recordings)))])
        else:
            label = int(random.integers(len(GESTURES)))
            samples.append((writer.draw(GESTURES[label], random), label))
    return samples


def _as_batch(samples: Sequence[Sample]) -> tuple[Tensor, Tensor]:
    images = np.stack([picture(stroke) for stroke, _ in samples])
    pixels = torch.from_numpy(images).to(torch.float32)[:, None].contiguous(memory_format=torch.channels_last)
    return pixels, torch.tensor([label for _, label in samples])


def _loss(logits: Tensor, labels: Tensor) -> Tensor:
    """Cross-entropy: of gestures against their label, of others against every gesture alike."""
    logs = functional.log_softmax(logits, dim=1)
    gestures = labels != NONE
    right = logs.gather(1, labels.clamp(min=0)[:, None])[:, 0]
    return -torch.where(gestures, right, logs.mean(dim=1)).mean()
