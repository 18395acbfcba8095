"""Long work beside the page: the kernel goes on answering while it is done."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any, Generic, TypeVar

T = TypeVar("T")
Report = Callable[[Any], None]


class Worker(Generic[T]):
    """Does one job at a time in a thread; of those that wait only the newest counts.

    What comes of a job is told on the event loop of the kernel, so that only the work itself runs beside it. Without a
    loop, as in a script, a job is done before `do` returns.

    Parameters
    ----------
    told : callable
        ``told(result)`` after a job.
    failed : callable
        ``failed(error)`` in its place, if the job raised an exception.
    reported : callable, optional
        ``reported(value)`` for what a job reports on its way.
    """

    def __init__(
        self,
        told: Callable[[T], None],
        failed: Callable[[Exception], None],
        reported: Callable[[Any], None] = lambda _: None,
    ) -> None:
        self._told, self._failed, self._reported = told, failed, reported
        self._next: Callable[[Report], T] | None = None
        self._counts: Callable[[Report], T] | None = None  # the job of which anything is told
        self._working: asyncio.Task[None] | None = None

    @property
    def waits(self) -> bool:
        """Whether another job follows the one that is being done."""
        return self._next is not None

    def do(self, job: Callable[[Report], T]) -> None:
        """Do a job: ``job(report)`` gives its result, and may call ``report(value)`` on its way."""
        self._next = job
        try:
            loop = asyncio.get_running_loop()
        except RuntimeError:
            self._next = None
            self._answer(job)
            return
        if self._working is None or self._working.done():
            self._working = loop.create_task(self._work(loop))

    def drop(self) -> None:
        """Forget what waits; what is being done is not told.

        The next job waits for its end all the same: a thread cannot be stopped.
        """
        self._next = self._counts = None

    async def _work(self, loop: asyncio.AbstractEventLoop) -> None:
        while (job := self._next) is not None:
            self._next, self._counts = None, job

            def report(value: Any, job: Callable[[Report], T] = job) -> None:
                loop.call_soon_threadsafe(lambda: self._counts is job and self._reported(value))

            try:
                result = await asyncio.to_thread(job, report)
                if self._counts is job:
                    self._told(result)
            except Exception as error:
                if self._counts is job:
                    self._failed(error)

    def _answer(self, job: Callable[[Report], T]) -> None:
        try:
            self._told(job(self._reported))
        except Exception as error:
            self._failed(error)
