"""Files of models and networks, read and written: safetensors, bounded in size, with a format in the header."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from safetensors import SafetensorError, safe_open

from .whole import whole

MAX_BYTES = 256 * 2**20


def read(
    path: Path, kind: str, wanted: str, framework: str = "numpy", former: Collection[str] = ()
) -> tuple[dict[str, str], dict[str, Any]]:
    """Header and tensors of a file.

    Parameters
    ----------
    path : Path
    kind : str
        What it should be, for messages: "face model".
    wanted : str
        The format that its header should name.
    framework : str
        Of the tensors: "numpy" or "pt".
    former : collection of str
        Other formats that will do.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is too large, damaged, or of another format; no tensor is read then.
    """
    if not path.is_file():
        raise FileNotFoundError(f"there is no {kind} at {path}")
    if path.stat().st_size > MAX_BYTES:
        raise ValueError(f"{path} is larger than the {MAX_BYTES >> 20} MB that a {kind} may have")
    try:
        with safe_open(path, framework=framework) as file:
            header = file.metadata() or {}
            if header.get("format") not in (wanted, *former):
                raise ValueError(f"{path} is no {kind}: its format is {header.get('format')!r}, not {wanted!r}")
            return header, {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118  (no mapping)
    except SafetensorError as error:
        raise ValueError(f"{path} is no safetensors file that can be read: {error}") from error


@contextmanager
def writing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """As `whole`, for safetensors: what it raises, as on a full disk, becomes an OSError that names the file."""
    with whole(path) as unfinished:
        try:
            yield unfinished
        except SafetensorError as error:
            raise OSError(f"{os.fspath(path)} cannot be written: {error}") from error
        unfinished.chmod(0o644)  # safetensors lets nobody else read what it writes
