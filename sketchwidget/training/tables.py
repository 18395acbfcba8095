"""Measurements as Markdown tables."""

from __future__ import annotations

import platform
from pathlib import Path

_SPLITS = {"random": "faces left out, identities seen", "identity": "identities left out"}


def accuracy_table(splits: dict[str, dict[str, float]], faces: int, command: str) -> str:
    """Mean vertex error by method (rows) and split (columns).

    Parameters
    ----------
    splits : dict of dict of float
        Errors in mm by method, by split.
    faces : int
        Of each split.
    command : str
        That made them.
    """
    rows = [
        "# Accuracy",
        "",
        f"Mean distance in mm between true and inferred skin vertices, over {faces:,} faces a column; the mean face is",
        f"200 mm high. Made by `{command}`.",
        "",
        "| | " + " | ".join(_SPLITS[name] for name in splits) + " |",
        "|---|" + "---|" * len(splits),
    ]
    for method in next(iter(splits.values())):
        rows.append(f"| {method} | " + " | ".join(f"{errors[method]:.2f}" for errors in splits.values()) + " |")
    return "\n".join(rows) + "\n"


def machine() -> str:
    """One line about this machine, for tables of timings."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        names = [line.partition(":")[2].strip() for line in cpuinfo.read_text().splitlines() if "model name" in line]
        model = f"{names[0]}, {len(names)} cores" if names else model
    return f"{model}; {platform.system()}, Python {platform.python_version()}"
