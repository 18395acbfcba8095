"""Arrays that long work keeps on its way, so that it is not done twice (.npz)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from .whole import whole


def keep(path: Path, arrays: Mapping[str, np.ndarray]) -> None:
    """Write arrays by name; a file that is there is whole."""
    with whole(path) as unfinished, open(unfinished, "wb") as file:
        np.savez(file, allow_pickle=False, **arrays)


def kept(path: Path, names: Iterable[str]) -> dict[str, np.ndarray]:
    """The arrays of a file by name.

    Raises
    ------
    ValueError
        If it is damaged, or has not all of them.
    """
    try:
        with np.load(path, allow_pickle=False) as stored:
            return {name: stored[name] for name in names}
    except (BadZipFile, EOFError, KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{path} is damaged; remove it to make it anew: {error}") from error
