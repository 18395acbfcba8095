"""How many threads a computation takes."""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager
from functools import cache
from typing import Literal

from threadpoolctl import ThreadpoolController


def one_thread(kind: Literal["blas"] | None = None) -> AbstractContextManager[object]:
    """A context in which NumPy, SciPy and torch compute on the calling thread alone.

    For what is small, as all that a stroke asks for: a second thread saves a few milliseconds where it has a core to
    itself, and costs tens of them where a browser draws on that core, or another pupil's kernel.

    Parameters
    ----------
    kind : "blas", optional
        Torch keeps its threads; those of NumPy and SciPy, for which it would wait, do not compete with them.
    """
    return _pools("torch" in sys.modules).limit(limits=1, user_api=kind)


@cache
def _pools(with_torch: bool) -> ThreadpoolController:
    """The pools of what is loaded now: those of NumPy and SciPy, and once it was needed those of torch."""
    return ThreadpoolController()
