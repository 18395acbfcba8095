"""What a training keeps so that it can go on: all of its state, now and then."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Protocol

import torch

from ..files import torchfile
from ..files.whole import whole


class Part(Protocol):
    """What has a state: a network, an optimizer."""

    def state_dict(self) -> dict[str, Any]:
        """The state."""
        ...

    def load_state_dict(self, state_dict: dict[str, Any]) -> Any:
        """Take over a state."""
        ...


class Checkpoints:
    """The checkpoints of one training, in one folder.

    Two are kept: the last, which only the same plan goes on from, and the last at which the learning rate had not yet
    fallen, from which also a longer plan does, as if it had been so long from the start.

    Parameters
    ----------
    folder : Path
    parts : dict of Part
        What is kept.
    about : str
        What the training is of: another one does not go on from these checkpoints.
    """

    def __init__(self, folder: Path, parts: dict[str, Part], about: str) -> None:
        self._folder, self._parts, self._about = folder, parts, about

    def resume(self, steps: int, level: int, device: torch.device) -> tuple[int, float]:
        """Take over the farthest checkpoint that a plan goes on from.

        Parameters
        ----------
        steps : int
            Of the whole plan.
        level : int
            Those of them before the learning rate falls.
        device : torch.device

        Returns
        -------
        done : int
            Steps behind it, 0 without a checkpoint.
        seconds : float
            That they took.

        Raises
        ------
        ValueError
            If a checkpoint is damaged or of another training, or all of them go beyond the plan.
        """
        states = [self._read(path, device) for name in ("last", "level") if (path := self._path(name)).exists()]
        usable = [
            state for state in states if state["plan"] == steps or (not state["falling"] and state["step"] <= level)
        ]
        if states and not usable:
            raise ValueError(
                f"the training in {self._folder} is at step {states[-1]['step']:,}, where one of {steps:,} steps would"
                " be slower already: ask for more steps, or name another --work"
            )
        if not usable:
            return 0, 0.0
        state = max(usable, key=lambda one: one["step"])
        for name, part in self._parts.items():
            part.load_state_dict(state[name])
        return state["step"], state["seconds"]

    def keep(self, step: int, seconds: float, steps: int, level: int) -> None:
        """Write the state after a step of a plan."""
        state = {name: part.state_dict() for name, part in self._parts.items()}
        state |= {"step": step, "seconds": seconds, "plan": steps, "falling": step > level, "about": self._about}
        for name in ("last", "level") if step <= level else ("last",):
            with whole(self._path(name)) as unfinished:
                torch.save(state, unfinished)

    def _path(self, name: str) -> Path:
        return self._folder / f"{name}.pt"

    def _read(self, path: Path, device: torch.device) -> dict[str, Any]:
        try:
            state = torchfile.read(path, device)
        except (OSError, ValueError) as error:
            raise ValueError(f"{path} is damaged; remove it to train anew: {error}") from error
        if not isinstance(state, dict) or state.get("about") != self._about:
            raise ValueError(
                f"{path} is of another training, of another layout, database or drawings: name another --out or"
                " --work, or remove it"
            )
        return state
