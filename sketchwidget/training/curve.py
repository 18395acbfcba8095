"""How a training goes, as a table: a row every so many steps."""

from __future__ import annotations

import csv
from pathlib import Path


class Curve:
    """A file of comma-separated values with a header; what lies after the step that a training goes on from is dropped.

    Parameters
    ----------
    path : Path
    columns : sequence of str
        After "step" and "seconds".
    step : int
        The last one that counts of a former sitting.
    """

    def __init__(self, path: Path, columns: list[str], step: int) -> None:
        self._path = path
        rows = read_curve(path)[1] if path.exists() else []
        kept = [row for row in rows if row[0] <= step]
        with path.open("w", newline="") as file:
            csv.writer(file).writerows([["step", "seconds", *columns], *map(_plain, kept)])

    def add(self, step: int, seconds: float, values: list[float]) -> None:
        """Write a row."""
        with self._path.open("a", newline="") as file:
            csv.writer(file).writerow(_plain([step, seconds, *values]))


def read_curve(path: Path) -> tuple[list[str], list[list[float]]]:
    """Names of the columns, and the rows."""
    with path.open(newline="") as file:
        names, *rows = csv.reader(file)
    return names, [[float(value) for value in row] for row in rows]


def _plain(row: list[float]) -> list[str]:
    step, seconds, *values = row
    return [f"{step:.0f}", f"{seconds:.0f}", *(f"{value:.4f}" for value in values)]
