"""Reading text files of bounded size, and writing them whole or not at all."""

from __future__ import annotations

import os

from .whole import whole

MAX_BYTES = 64 * 2**20


def read(path: str | os.PathLike[str]) -> str:
    """The text of a UTF-8 file.

    Raises
    ------
    ValueError
        If the file is larger than 64 MB or no text.
    OSError
        If it cannot be read.
    """
    with open(path, "rb") as file:
        content = file.read(MAX_BYTES + 1)
    return as_text(content)


def as_text(content: bytes) -> str:
    """The text of a UTF-8 file's content.

    Raises
    ------
    ValueError
        If it is larger than 64 MB or no text.
    """
    if len(content) > MAX_BYTES:
        raise ValueError(f"larger than {MAX_BYTES // 2**20} MB")
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        raise ValueError(f"not text: byte {error.start} is no UTF-8") from error


def write(path: str | os.PathLike[str], text: str) -> None:
    """Write a UTF-8 file in one step: a crash or a full disk leaves the former file as it was.

    Raises
    ------
    ValueError
        If the text is larger than `read` accepts.
    OSError
        If it cannot be written.
    """
    content = text.encode()
    if len(content) > MAX_BYTES:
        raise ValueError(
            f"{path}: {len(content):,} bytes are more than the {MAX_BYTES // 2**20} MB that can be read back"
        )
    with whole(path, synced=False) as unfinished:  # sessions are written with every stroke
        unfinished.write_bytes(content)
