"""Files of records that grow one by one: JSON lines, a header and then one record a line."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from itertools import chain
from pathlib import Path
from typing import IO, Any, ClassVar, Generic, Protocol, TypeVar

from .whole import whole

MAX_BYTES = 512 * 2**20  # of a file
MAX_LINE = 8 * 2**20  # bytes of a record

VERSION = 1


class Record(Protocol):
    """What a file holds: a dataclass made of the fields of its JSON object."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    def to_json(self) -> dict[str, Any]:
        """The record as a JSON object, a value for each field."""
        ...


R = TypeVar("R", bound=Record)


@dataclass(frozen=True)
class RecordFile(Generic[R]):
    """How records of one kind are read and written.

    Parameters
    ----------
    kind : type
        Of the records; its constructor raises a ValueError for fields that are none of a record.
    name : str
        Of a record, for messages: "drawing".
    """

    kind: type[R]
    name: str

    @property
    def format(self) -> str:
        """What the header of a file names."""
        return f"sketchwidget {self.name}s"

    def read(self, path: str | os.PathLike[str]) -> list[R]:
        """The records of a file, in the order they were added.

        A last line that was cut short, as when a kernel dies while it writes, is left out with a warning.

        Raises
        ------
        ValueError
            If the file is larger than 512 MB, holds no such records, is of a newer version, or has a line that is no
            record; the message names the file and the line.
        OSError
            If it cannot be read.
        """
        with open(path, "rb") as file:
            return list(self._read(file, os.fspath(path)))

    def write(self, path: str | os.PathLike[str], records: Iterable[R]) -> None:
        """Write a file in one step: a crash or a full disk leaves a former one as it was.

        Raises
        ------
        ValueError
            If it would be larger than `read` accepts.
        OSError
            If it cannot be written.
        """
        with whole(path) as unfinished, open(unfinished, "wb") as file:
            for line in chain([self._header], map(_line, records)):
                file.write(line)
                _require_room(path, file.tell())

    def append(self, path: str | os.PathLike[str], record: R) -> None:
        """Add a record to a file, a new one if there is none; it is on the disk when this returns.

        A last line that was cut short goes, with a warning.

        Raises
        ------
        ValueError
            If the file holds other records, or would be larger than `read` accepts.
        OSError
            If it cannot be written.
        """
        if not Path(path).exists():
            self.write(path, [record])
            return
        line = _line(record)
        with open(path, "r+b") as file:
            self._check_header(file.readline(MAX_LINE), os.fspath(path))
            size = self._mended(file, os.fspath(path))
            _require_room(path, size + len(line))
            file.seek(size)
            file.write(line)
            file.flush()
            os.fsync(file.fileno())

    def take_back(self, path: str | os.PathLike[str], record: R) -> None:
        """Remove a record that was the last to be added.

        Raises
        ------
        ValueError
            If the last line of the file is not this record; the file is as before.
        OSError
            If it cannot be written.
        """
        line = _line(record)
        with open(path, "r+b") as file:
            size = file.seek(0, os.SEEK_END) - len(line)
            file.seek(max(0, size))
            if size < len(self._header) or file.read() != line:
                raise ValueError(f"the last line of {os.fspath(path)} is another {self.name}")
            file.truncate(size)

    def merge(self, paths: Iterable[str | os.PathLike[str]], out: str | os.PathLike[str]) -> tuple[int, int]:
        """Write the records of several files into one, in order, each of those that are equal once.

        Parameters
        ----------
        paths : iterable of paths
        out : path
            A new file, or one of `paths`: others are not overwritten.

        Returns
        -------
        kept, dropped : int
            Numbers of records.

        Raises
        ------
        ValueError, OSError
            As `read` and `write` do; no file has changed then.
        FileExistsError
            If there is such a file and it is none of those to be merged.
        """
        paths, out = [Path(path) for path in paths], Path(out)
        if out.exists() and not any(path.exists() and path.samefile(out) for path in paths):
            raise FileExistsError(f"{out} exists, and is none of the files to be merged: name a new file")
        records = [record for path in paths for record in self.read(path)]
        once = dict.fromkeys(records)
        self.write(out, once)
        return len(once), len(records) - len(once)

    @property
    def _header(self) -> bytes:
        return _as_line({"format": self.format, "version": VERSION})

    def _read(self, file: IO[bytes], name: str) -> Iterator[R]:
        if os.fstat(file.fileno()).st_size > MAX_BYTES:
            raise ValueError(f"{name} is larger than the {MAX_BYTES >> 20} MB that a file of {self.name}s may have")
        self._check_header(file.readline(MAX_LINE), name)
        number = 1
        while line := file.readline(MAX_LINE + 1):
            number += 1
            if len(line) > MAX_LINE:
                raise ValueError(f"{name}, line {number} is longer than the {MAX_LINE >> 20} MB of a {self.name}")
            if _is_cut_short(line):
                self._warn_of_cut(name)
            else:
                yield self._record(line, f"{name}, line {number}")

    def _check_header(self, line: bytes, name: str) -> None:
        try:
            header = json.loads(line)
        except (ValueError, RecursionError):
            header = None
        if not isinstance(header, dict) or header.get("format") != self.format:
            raise ValueError(f'{name} holds no {self.name}s: its first line has no "format": "{self.format}"')
        if (version := header.get("version")) != VERSION:
            raise ValueError(f"{name} is of version {version!r}; this sketchwidget reads version {VERSION}")

    def _record(self, line: bytes, where: str) -> R:
        try:
            given = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise ValueError(f"{where} is no JSON: {error}") from error
        expected = [field.name for field in fields(self.kind)]
        if not isinstance(given, dict) or given.keys() != set(expected):
            raise ValueError(f"{where} is no {self.name}: it is an object of {', '.join(expected)}")
        try:
            return self.kind(**given)
        except ValueError as error:
            raise ValueError(f"{where} is no {self.name}: {error}") from error

    def _mended(self, file: IO[bytes], name: str) -> int:
        """The size of a file whose lines all have an end: one that lacks it gets it, or goes if it was cut short."""
        size = file.seek(0, os.SEEK_END)
        tail = min(size, MAX_LINE)
        file.seek(size - tail)
        last = file.read(tail).rpartition(b"\n")[2]
        if not last:
            return size
        if _is_cut_short(last):
            self._warn_of_cut(name)
            return file.truncate(size - len(last))
        file.write(b"\n")
        return size + 1

    def _warn_of_cut(self, name: str) -> None:
        warnings.warn(f"the last {self.name} in {name} was cut short and is left out", stacklevel=4)


def _line(record: Record) -> bytes:
    return _as_line(record.to_json())


def _as_line(content: dict[str, Any]) -> bytes:
    return json.dumps(content, separators=(",", ":")).encode() + b"\n"


def _is_cut_short(line: bytes) -> bool:
    """Whether a line without its end is no JSON; an editor may have taken the end from a whole one."""
    if line.endswith(b"\n"):
        return False
    try:
        json.loads(line)
    except (ValueError, RecursionError):
        return True
    return False


def _require_room(path: str | os.PathLike[str], size: int) -> None:
    if size > MAX_BYTES:
        raise ValueError(f"{os.fspath(path)} would be larger than the {MAX_BYTES >> 20} MB that can be read back")
