"""Files that torch.save wrote, read without running anything that they hold."""

from __future__ import annotations

from pathlib import Path
from typing import Any


def read(path: Path, device: Any = "cpu") -> Any:
    """What a file holds: tensors, and plain values about them.

    Raises
    ------
    OSError
        If it cannot be opened.
    ValueError
        If it is damaged, or holds anything else; nothing of it has run then.
    """
    import torch

    with open(path, "rb") as file:
        try:
            return torch.load(file, weights_only=True, map_location=device)
        except Exception as error:  # damaged bytes trip the unpickler in every way
            raise ValueError(f"{path} holds more than tensors, or is damaged: {error!r}") from error
