"""What thirty pupils need: kernels with a Studio each, and somebody who draws in every one of them, on this machine.

    python -m benchmarks.hub [--pupils 30]

Each pupil is a Jupyter kernel with a Studio, and a client that plays recorded sessions in it: a stroke goes to the pad
as a page sends it, in parts while the pen is down and whole when it is up; eraser, modes and gestures go as a cell.
After each comes a pause to think. *Answered* is from the pen's end to the kernel's word that the stroke is done, by
when the head has been sent: without a page, a server and a network. Kernels are added in steps, one after the other,
and measured at each. Memory is the proportional set size, in which what kernels share counts once; what one more takes
is what the sum grew by. All is bounded by the number of edits, and no kernel outlives the measurement. Linux only.
"""

from __future__ import annotations

import argparse
import itertools
import os
import queue
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import psutil
from jupyter_client.manager import KernelManager

import sketchwidget as sw
from sketchwidget.session import Draw, Event
from sketchwidget.session.file import line
from sketchwidget.training.tables import machine

from .sessions import SCRIPTS

HERE = Path(__file__).parent
TABLE = HERE / "HUB.md"
STEPS = (1, 5, 10, 20, 30)
EDITS = 10  # of each pupil at each step
THINKING = (1.0, 5.0)  # seconds between two edits, evenly spread
PEN_SPEED = 0.6  # canvas units a second
PATIENCE = 120.0  # seconds, for any answer
SPARE_MB = 1500  # of the machine's memory: with less than this left no kernel is added
_MB = 2**20

# As pacing.js has it.
PARTIAL_EVERY, REST = 1 / 15, 3

BEGIN = """
import json
import sketchwidget as sw
from sketchwidget.session.events import event_from_json
studio = sw.Studio()
"""
AFRESH = "studio.session = sw.Session(studio.session.regressor)"
# One thread a kernel: with more, the pupils' networks would wait for each other's.
THREADS = {"OMP_NUM_THREADS": "1"}


@dataclass(frozen=True)
class Step:
    """What was measured with so many pupils at work.

    Parameters
    ----------
    pupils : int
    proportional, resident : float
        MB of all kernels together.
    answered : (n,) array
        Milliseconds from the end of each stroke to its answer.
    cpu : float
        Seconds of processor time that the kernels took for an edit, on average, parts of strokes included.
    busy : float
        Processors that the kernels kept busy.
    """

    pupils: int
    proportional: float
    resident: float
    answered: np.ndarray
    cpu: float
    busy: float


class Pupil:
    """A kernel with a Studio, and who draws in it.

    Parameters
    ----------
    manager : KernelManager
        Of a running kernel.
    recorded : sequence of Event
        A session, played again and again.
    seed : int
        Of the pauses.
    """

    def __init__(self, manager: KernelManager, recorded: Sequence[Event], seed: int) -> None:
        self._random = Random(seed)
        self._events = itertools.cycle([None, *recorded])  # None: begin afresh
        self._client = manager.client()
        self._client.start_channels()
        self._client.wait_for_ready(PATIENCE)
        self.process = psutil.Process(manager.provisioner.pid)  # type: ignore[union-attr]
        self._strokes = 0
        self._took = 0.0  # seconds that the last part's answer took
        self._comms: dict[str, str] = {}
        self._run(BEGIN)
        for widget in ("Ink", "MeshStream"):
            self._tell(widget, {"type": "ready"})
        self._run("studio.session.prepare()")

    def close(self) -> None:
        """Part from the kernel."""
        self._client.stop_channels()

    def work(self, edits: int, thinking: tuple[float, float]) -> list[float]:
        """Do the next edits of the session; milliseconds until each stroke was answered."""
        answered = []
        for _ in range(edits):
            event = next(self._events)
            time.sleep(self._random.uniform(*thinking))
            if isinstance(event, Draw):
                answered.append(1000 * self._draw(event.points))
            elif event is None:
                self._run(AFRESH)
            else:
                self._run(f"studio.session.do(event_from_json(json.loads({line(event)!r})))")
        return answered

    def _draw(self, points: np.ndarray) -> float:
        """Draw a stroke at a hand's pace; seconds until its end was answered."""
        self._strokes += 1
        stroke = f"stroke-{self._strokes}"
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]) / PEN_SPEED
        samples = np.column_stack([points, np.full(len(points), 0.5), 1000 * along]).astype("<f4")
        began = time.monotonic()
        while (down := time.monotonic() - began) < along[-1]:
            drawn = int(np.searchsorted(along, down))
            if drawn >= 2:
                self._took = self._ask("followed", {"type": "partial", "stroke": stroke}, samples[:drawn])
            pause = max(PARTIAL_EVERY, REST * self._took) - (time.monotonic() - began - down)
            time.sleep(max(0.0, min(pause, along[-1] - (time.monotonic() - began))))
        return self._ask("dry", {"type": "stroke", "stroke": stroke, "tool": 0}, samples)

    def _ask(self, answer: str, content: dict[str, Any], samples: np.ndarray) -> float:
        """Send points to the pad; seconds until it answers."""
        asked = time.monotonic()
        self._tell("Ink", {**content, "mirror": False}, samples.tobytes())
        while time.monotonic() - asked < PATIENCE:
            said = self._heard(PATIENCE).get("data", {}).get("content") or {}
            if said.get("type") == answer and said.get("stroke") == content["stroke"]:
                return time.monotonic() - asked
        raise TimeoutError(f"no answer within {PATIENCE:.0f} s")

    def _tell(self, widget: str, content: dict[str, Any], *buffers: bytes) -> None:
        data = {"method": "custom", "content": content}
        message = self._client.session.msg("comm_msg", {"comm_id": self._comms[widget], "data": data})
        self._client.session.send(self._client.shell_channel.socket, message, buffers=list(buffers) or None)

    def _run(self, code: str) -> None:
        """Run a cell; RuntimeError if it fails."""
        asked = self._client.execute(code)
        while True:
            reply = self._client.get_shell_msg(timeout=PATIENCE)
            if reply["parent_header"].get("msg_id") == asked:
                break
        if reply["content"]["status"] != "ok":
            raise RuntimeError(f"{code}: {reply['content']}")
        try:
            while True:
                self._heard(0.05)
        except queue.Empty:
            return

    def _heard(self, timeout: float) -> dict[str, Any]:
        """The content of the next message that the kernel tells everybody; widgets are met on the way."""
        message = self._client.get_iopub_msg(timeout=timeout)
        content = message["content"]
        if message["msg_type"] == "comm_open":
            kind = content["data"]["state"].get("_anywidget_id", "")
            self._comms[kind.rpartition(".")[2]] = content["comm_id"]
        return content


def recorded() -> list[tuple[Event, ...]]:
    """The events of the scripted sessions: drawing, lines drawn anew, gestures."""
    regressor, sessions = sw.FaceRegressor.load(), []
    for script in SCRIPTS:
        session = sw.Session(regressor)
        script.play(session)
        sessions.append(session.events)
    return sessions


@contextmanager
def kernel() -> Iterator[KernelManager]:
    """A kernel that ends with the context."""
    manager = KernelManager()
    paths = os.pathsep.join(filter(None, [str(HERE.parent), os.environ.get("PYTHONPATH")]))
    # The error stream of thirty kernels that are told to end is no news.
    with TemporaryDirectory() as state:
        env = {**os.environ, **THREADS, "PYTHONPATH": paths, "XDG_STATE_HOME": state}
        manager.start_kernel(env=env, stderr=subprocess.DEVNULL)
        try:
            yield manager
        finally:
            manager.shutdown_kernel(now=True)


def measure(steps: Sequence[int] = STEPS, edits: int = EDITS, thinking: tuple[float, float] = THINKING) -> list[Step]:
    """Let so many pupils work, step by step; fewer steps than asked for if the memory does not suffice."""
    measured, sessions, pupils = [], recorded(), []
    with ExitStack() as stack:
        for count in steps:
            while len(pupils) < count:
                if psutil.virtual_memory().available < SPARE_MB * _MB:
                    return measured
                number = len(pupils)
                pupil = Pupil(stack.enter_context(kernel()), sessions[number % len(sessions)], number)
                stack.callback(pupil.close)
                pupils.append(pupil)
            measured.append(_at_work(pupils, edits, thinking))
            print(f"{count} pupils: {np.median(measured[-1].answered):.0f} ms", file=sys.stderr, flush=True)
    return measured


def _at_work(pupils: Sequence[Pupil], edits: int, thinking: tuple[float, float]) -> Step:
    before, began = _processor_seconds(pupils), time.monotonic()
    with ThreadPoolExecutor(len(pupils)) as hands:
        answered = [wait for one in hands.map(lambda pupil: pupil.work(edits, thinking), pupils) for wait in one]
    took, lasted = _processor_seconds(pupils) - before, time.monotonic() - began
    memory = [pupil.process.memory_full_info() for pupil in pupils]
    return Step(
        len(pupils),
        sum(one.pss for one in memory) / _MB,
        sum(one.rss for one in memory) / _MB,
        np.array(answered),
        took / (edits * len(pupils)),
        took / lasted,
    )


def _processor_seconds(pupils: Sequence[Pupil]) -> float:
    times = [pupil.process.cpu_times() for pupil in pupils]
    return sum(one.user + one.system for one in times)


def server_megabytes() -> float:
    """What a pupil's own Jupyter server holds that nobody shares, in MB, before anybody has opened a page."""
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--ServerApp.port=0"]
    server = subprocess.Popen(command, cwd=HERE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        time.sleep(15)
        return psutil.Process(server.pid).memory_full_info().uss / _MB
    finally:
        server.terminate()
        server.wait(20)


def _row(step: Step) -> str:
    median, late = np.percentile(step.answered, [50, 95])
    each = f"{step.resident / step.pupils:.0f} | {step.proportional / step.pupils:.0f}"
    return (
        f"| {step.pupils} | {each} | {step.proportional / 1024:.1f} | {median:.0f} ms | {late:.0f} ms "
        f"| {1000 * step.cpu:.0f} ms | {step.busy:.2f} |"
    )


def _report(measured: Sequence[Step], server: float, load: float) -> str:
    first, last = measured[0], measured[-1]
    kernel = (last.proportional - first.proportional) / max(1, last.pupils - first.pupils)
    kernels, servers = last.proportional / 1024, last.pupils * server / 1024
    lines = [
        "# A class on one machine",
        "",
        "So many pupils at work at once, each with a kernel of one thread and a Studio in it: recorded sessions",
        "through all modes, strokes at a hand's pace and sent while they are drawn, "
        f"{THINKING[0]:.0f} to {THINKING[1]:.0f} s to think between two edits.",
        f"Made by `python -m benchmarks.hub` on: {machine()}, {psutil.virtual_memory().total / _MB / 1024:.0f} GB,",
        f"where the clients that draw ran too; processes that wanted a processor before they began: {load:.0f}.",
        "",
        "| pupils | MB of a kernel, resident | MB, its share | GB of all | stroke answered, median | within, 95 % "
        "| processor time of an edit | processors busy |",
        "|---|---|---|---|---|---|---|---|",
        *map(_row, measured),
        "",
        f"One more kernel takes {kernel:.0f} MB of the machine: kernels share what they load from the same files. A",
        "limit for each must allow for all that is resident. A pupil's Jupyter server, which is not in the table, has",
        f"{server:.0f} MB of its own. So {last.pupils} pupils take {kernels:.1f} GB for kernels, {servers:.1f} GB for",
        f"servers, and {last.busy:.1f} processors while all of them draw.",
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the table beside this file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pupils", type=int, default=STEPS[-1])
    wanted = parser.parse_args().pupils
    load = os.getloadavg()[0]
    measured = measure([step for step in STEPS if step < wanted] + [wanted])
    TABLE.write_text(_report(measured, server_megabytes(), load))
    print(TABLE.read_text())


if __name__ == "__main__":
    main()
