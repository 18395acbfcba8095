"""Performances: weights of ARKit's expressions over time, and what drives an avatar with them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib.resources import files

import numpy as np

from .template import AvatarTemplate

FPS = 30.0


@dataclass(frozen=True, eq=False)
class Performance:
    """Key-framed weights, linear between the frames.

    Parameters
    ----------
    name : str
    times : (k,) array
        Seconds, growing from 0.
    weights : dict of (k,) arrays
        By ARKit's name; what is not named stays at rest.

    Raises
    ------
    ValueError
        If times do not grow from 0, or a track has another number of weights.
    """

    name: str
    times: np.ndarray
    weights: Mapping[str, np.ndarray]

    def __post_init__(self) -> None:
        if not len(self.times) or self.times[0] != 0 or (np.diff(self.times) <= 0).any():
            raise ValueError(f"the times of a performance grow from 0; {self.name!r} has {list(self.times)}")
        for name, track in self.weights.items():
            if len(track) != len(self.times):
                raise ValueError(f"{self.name!r} has {len(self.times)} times and {len(track)} weights of {name}")

    @property
    def duration(self) -> float:
        """Seconds."""
        return float(self.times[-1])

    def at(self, time: float) -> dict[str, float]:
        """The weights at a time in seconds; before and after, those of the first and the last frame."""
        return {name: float(np.interp(time, self.times, track)) for name, track in self.weights.items()}

    def __iter__(self) -> Iterator[dict[str, float]]:
        """The weights of each frame at 30 frames a second."""
        for frame in range(int(self.duration * FPS) + 1):
            yield self.at(frame / FPS)

    @classmethod
    def recorded(cls, name: str, frames: Iterable[Mapping[str, float]], fps: float = FPS) -> Performance:
        """A performance of frames of weights, as a driver gives them."""
        given = [dict(frame) for frame in frames]
        names = dict.fromkeys(name for frame in given for name in frame)
        tracks = {key: np.array([frame.get(key, 0.0) for frame in given]) for key in names}
        return cls(name, np.arange(len(given)) / fps, tracks)


def performances() -> dict[str, Performance]:
    """The ready performances, by name."""
    read = json.loads(files("sketchwidget.avatar").joinpath("performances.json").read_text())
    known = set(AvatarTemplate.load().action_names)
    ready = {}
    for name, keys in read.items():
        times = np.array([time for time, _ in keys])
        used = dict.fromkeys(action for _, weights in keys for action in weights)
        if unknown := used.keys() - known:
            raise ValueError(f"the performance {name!r} uses {', '.join(sorted(unknown))}, which no rig has")
        tracks = {action: np.array([weights.get(action, 0.0) for _, weights in keys]) for action in used}
        ready[name] = Performance(name, times, tracks)
    return ready
