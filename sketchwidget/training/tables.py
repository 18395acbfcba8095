"""Measurements as Markdown tables."""

from __future__ import annotations

import platform
from pathlib import Path

import numpy as np

_SPLITS = {"random": "people seen", "identity": "people left out"}


def accuracy_table(splits: dict[str, dict[str, dict[str, np.ndarray]]], faces: int, command: str) -> str:
    """Mean vertex error by method (rows), split and manner (columns).

    Parameters
    ----------
    splits : dict of dict of dict of arrays
        Errors in mm at each vertex, by method, by manner of drawing, by split.
    faces : int
        Of each split.
    command : str
        That made them.
    """
    columns = [(split, manner) for split, manners in splits.items() for manner in manners]
    rows = [
        "# Accuracy",
        "",
        f"Mean distance in mm between true and inferred skin vertices, over {faces:,} faces a column; the mean face is",
        "200 mm high. None was trained on: of people seen they are of a tenth of what the paper trains and tests on,",
        "its database of 150 people and faces interpolated between these. Drawings are exact, with the augmentation of",
        "the paper's 4.4 (noisy view, lines removed and deformed), or freehand by a simulated hand; which line each",
        "stroke is, is known, and, but in a Studio, which point of it each one is: there points are found by shares of",
        "the length along the lines of the head that the pixels alone give. MMfitting moves the mean face by the lines",
        f"alone, features point for point. Made by `{command}`.",
        "",
        "| | " + " | ".join(f"{_SPLITS[split]}: {manner}" for split, manner in columns) + " |",
        "|---|" + "---|" * len(columns),
    ]
    for method in splits[columns[0][0]][columns[0][1]]:
        errors = (splits[split][manner][method] for split, manner in columns)
        rows.append(f"| {method} | " + " | ".join(f"{error.mean():.2f}" for error in errors) + " |")
    return "\n".join(rows) + "\n"


def machine() -> str:
    """One line about this machine, for tables of timings."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        names = [line.partition(":")[2].strip() for line in cpuinfo.read_text().splitlines() if "model name" in line]
        model = f"{names[0]}, {len(names)} cores" if names else model
    return f"{model}; {platform.system()}, Python {platform.python_version()}"
