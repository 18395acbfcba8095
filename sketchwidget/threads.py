"""How many threads a computation takes."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Lock
from typing import Literal

from threadpoolctl import ThreadpoolController


@contextmanager
def one_thread(kind: Literal["blas"] | None = None) -> Iterator[None]:
    """A context in which NumPy, SciPy and torch compute on the calling thread alone.

    For what is small, as all that a stroke asks for: a second thread saves a few milliseconds where it has a core to
    itself, and costs tens of them where a browser draws on that core, or another pupil's kernel.

    Parameters
    ----------
    kind : "blas", optional
        Torch keeps its threads; those of NumPy and SciPy, for which it would wait, do not compete with them.
    """
    # While it is being imported, in another thread perhaps, torch has neither this function nor its threads.
    torch_threads = getattr(sys.modules.get("torch"), "get_num_threads", None)
    with _blas:
        if kind == "blas" or torch_threads is None:
            yield
        else:
            torch_threads()  # the first question in a thread makes torch set its number there
            with _pools("openmp").limit(limits=1):
                yield


class _Blas:
    """One thread for NumPy and SciPy, for all of a program: from the first that asks to the last that leaves."""

    def __init__(self) -> None:
        self._lock, self._inside = Lock(), 0

    def __enter__(self) -> None:
        with self._lock:
            if self._inside == 0:
                self._limit = _pools("blas").limit(limits=1)
            self._inside += 1

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._inside -= 1
            if self._inside == 0:
                self._limit.restore_original_limits()


_blas = _Blas()


@cache
def _pools(kind: Literal["blas", "openmp"]) -> ThreadpoolController:
    """The pools of what is loaded at the first call, alone: a limit that ends sets all pools to what they were."""
    return ThreadpoolController().select(user_api=kind)
