"""The processes that train one network together, as ``torchrun`` starts them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import timedelta

import torch
from torch import distributed

_PATIENCE = timedelta(hours=12)  # of processes that wait for what the leader makes


@dataclass(frozen=True)
class Team:
    """This process and the others.

    Parameters
    ----------
    rank : int
        Of this process; 0 leads.
    size : int
    device : torch.device
        A GPU of its own where there are some.
    """

    rank: int
    size: int
    device: torch.device

    @classmethod
    def join(cls) -> Team:
        """The team that ``torchrun`` started, or this process alone."""
        rank, size, place = (
            int(os.environ.get(name, alone)) for name, alone in (("RANK", 0), ("WORLD_SIZE", 1), ("LOCAL_RANK", 0))
        )
        device = torch.device("cuda", place) if torch.cuda.is_available() else torch.device("cpu")
        if device.type == "cuda":
            torch.cuda.set_device(device)
        if size > 1 and not distributed.is_initialized():
            distributed.init_process_group("nccl" if device.type == "cuda" else "gloo", timeout=_PATIENCE)
        return cls(rank, size, device)

    @property
    def leads(self) -> bool:
        """Whether this process writes the files."""
        return self.rank == 0

    @contextmanager
    def leader_first(self) -> Iterator[None]:
        """What the leader makes and keeps here, the others find."""
        if not self.leads:
            distributed.barrier()
        yield
        if self.leads and self.size > 1:
            distributed.barrier()
