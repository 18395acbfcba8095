"""Writing a file whole or not at all."""

from __future__ import annotations

import glob
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_LEFT_OVER = 24 * 3600.0  # seconds without a change: nobody writes it any more


@contextmanager
def whole(path: str | os.PathLike[str], synced: bool = True) -> Iterator[Path]:
    """A path to write what is to become a file: a crash or a full disk leaves a former one as it was.

    It is beside the file, so that one step puts it in the file's place once the block ends. If the block raises, it
    goes.

    Parameters
    ----------
    path : path-like
    synced : bool
        Whether to wait until it is on the disk, which a network's disk may take long for: a failure of the power, too,
        leaves a whole file then.

    Raises
    ------
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> with whole("notes.txt") as unfinished:
    ...     unfinished.write_text("all of it")
    """
    path = Path(os.path.realpath(path))  # a link stays one
    if synced:  # what is written with every stroke is small, and looks through no folder
        _remove_left_over(path)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield unfinished
        if synced:
            with open(unfinished, "rb+") as file:
                os.fsync(file.fileno())
        if path.exists():
            shutil.copymode(path, unfinished)
        os.replace(unfinished, path)
    except BaseException as error:
        unfinished.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename == os.fspath(unfinished):
            error.filename, error.filename2 = os.fspath(path), None  # the only name that a reader of the message knows
        raise


def _remove_left_over(path: Path) -> None:
    """Remove what processes that were killed long ago have left beside a file."""
    for unfinished in path.parent.glob(f".{glob.escape(path.name)}.*.part"):
        with suppress(OSError):
            if time.time() - unfinished.stat().st_mtime > _LEFT_OVER:
                unfinished.unlink()
