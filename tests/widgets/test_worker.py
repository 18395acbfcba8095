import asyncio
import threading
import time

from sketchwidget.widgets.worker import Worker


def worker():
    told = []
    return Worker(
        lambda result: told.append(("told", result)), lambda e: told.append(("failed", str(e))), told.append
    ), told


def test_in_a_script_a_job_is_done_at_once():
    made, told = worker()

    def job(report):
        report("half")
        return threading.current_thread() is threading.main_thread()

    made.do(job)
    made.do(lambda _: 1 / 0)
    assert told == ["half", ("told", True), ("failed", "division by zero")]


def test_in_a_kernel_it_is_done_beside_and_told_on_the_loop():
    made, told = worker()

    async def run():
        started, go = threading.Event(), threading.Event()

        def job(report):
            started.set()
            go.wait(10)
            report("half")
            return threading.current_thread() is threading.main_thread()

        made.do(job)
        await asyncio.to_thread(started.wait, 10)
        assert told == []  # the loop goes on while the job waits
        made.do(lambda _: "dropped for a newer one")
        made.do(lambda _: "newest")
        go.set()
        while len(told) < 3:
            await asyncio.sleep(0.01)

    asyncio.run(asyncio.wait_for(run(), 20))
    assert told == ["half", ("told", False), ("told", "newest")]


def test_what_is_dropped_is_not_told_and_work_goes_on_after():
    made, told = worker()

    async def run():
        started, go = threading.Event(), threading.Event()

        def job(report):
            started.set()
            go.wait(10)
            report("half")
            return "late"

        made.do(job)
        await asyncio.to_thread(started.wait, 10)
        made.do(lambda _: "waiting")
        made.drop()
        go.set()
        made.do(lambda _: "next")
        while not told:
            await asyncio.sleep(0.01)
        await asyncio.sleep(0.05)

    asyncio.run(asyncio.wait_for(run(), 20))
    assert told == [("told", "next")]


def test_a_job_waits_for_the_end_of_one_that_was_dropped():
    made, told = worker()
    at_once, most = [], []

    def job(_):
        at_once.append(1)
        most.append(len(at_once))
        time.sleep(0.05)
        at_once.pop()
        return len(most)

    async def run():
        for _ in range(4):
            made.do(job)
            await asyncio.sleep(0.01)
            made.drop()
        made.do(job)
        while not told:
            await asyncio.sleep(0.01)

    asyncio.run(asyncio.wait_for(run(), 20))
    assert max(most) == 1 and len(told) == 1


def test_work_goes_on_after_an_answer_that_failed():
    told = []

    def tell(result):
        if result == "bad":
            raise ValueError("no head")
        told.append(result)

    made = Worker(tell, lambda error: told.append(str(error)))

    async def run():
        made.do(lambda _: "bad")
        while not told:
            await asyncio.sleep(0.01)
        made.do(lambda _: "good")
        while len(told) < 2:
            await asyncio.sleep(0.01)

    asyncio.run(asyncio.wait_for(run(), 20))
    assert told == ["no head", "good"]
