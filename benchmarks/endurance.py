"""A long session with a Studio in one Python: thousands of edits through all modes, and the memory while it lasts.

python -m benchmarks.endurance [--edits 3000]
"""

from __future__ import annotations

import argparse
import itertools
import os
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import sketchwidget as sw
from sketchwidget.training.tables import machine

from .sessions import SCRIPTS, Artist

HERE = Path(__file__).parent
TABLE, CURVE = HERE / "ENDURANCE.md", HERE / "endurance.png"
REDONE = 10  # edits done again, and taken back once more, after each head
_PAGE_MB = os.sysconf("SC_PAGE_SIZE") / 2**20


@dataclass(frozen=True)
class Sample:
    """The memory after so many edits.

    Parameters
    ----------
    edits : int
    megabytes : float
        Resident.
    """

    edits: int
    megabytes: float


def resident() -> float:
    """What of this process is in memory, in MB (Linux)."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * _PAGE_MB


def endure(edits: int) -> list[Sample]:
    """Make one head after the other in a Studio, until so many edits are done; the memory after each.

    Each head goes from a blank pad through drawing, follow-up sketching and gestures and is exaggerated; what gestures
    did is taken back, for the next head is to begin without it. What is left is taken over, as a tab gives heads, and
    one of its lines drawn anew. Then the pad is cleared: the session is one and grows.
    """
    studio = sw.Studio()
    session = studio.session
    session.prepare()
    samples = [Sample(0, resident())]
    for script in itertools.cycle(SCRIPTS):
        script.play(session)
        session.exaggerate(1.5)
        _take_gestures_back(session)
        for _ in range(REDONE):
            session.redo()
        _take_gestures_back(session)
        _edit_taken(session)
        session.mode = "initial"
        session.clear()
        samples.append(Sample(len(session.events), resident()))
        if len(session.events) >= edits:
            return samples
    raise AssertionError("a cycle has no end")


def _take_gestures_back(session: sw.Session) -> None:
    while session.mode == "refine" or session.refinement.layer is not None:
        session.undo()


def _edit_taken(session: sw.Session) -> None:
    session.take_over(session.face.vertices)
    Artist(session).redraw("nose", (0, 0.01))


def growth(samples: list[Sample]) -> float:
    """MB by which the memory grows in a thousand edits, over the second half of them: caches fill in the first."""
    late = samples[len(samples) // 2 :]
    return 1000 * float(np.polyfit([s.edits for s in late], [s.megabytes for s in late], 1)[0])


def main() -> None:
    """Write the curve and the table beside this file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--edits", type=int, default=3000)
    samples = endure(parser.parse_args().edits)
    figure, axis = plt.subplots(figsize=(7, 2.6), layout="constrained")
    axis.plot([s.edits for s in samples], [s.megabytes for s in samples])
    axis.set(xlabel="edits", ylabel="MB resident", ylim=(0, None))
    figure.savefig(CURVE, dpi=110)
    middle, last = samples[len(samples) // 2], samples[-1]
    TABLE.write_text(
        f"""# A long session

{last.edits:,} edits in one Studio, {len(samples) - 1} heads from a blank pad through all modes, each taken over once.
Made by `python -m benchmarks.endurance` on: {machine()}.

| | MB resident |
|---|---|
| a Studio with its network | {samples[0].megabytes:.0f} |
| after the first head ({samples[1].edits} edits) | {samples[1].megabytes:.0f} |
| half way ({middle.edits:,} edits) | {middle.megabytes:.0f} |
| at the end ({last.edits:,} edits) | {last.megabytes:.0f} |
| growth in a thousand edits, second half | {growth(samples):.1f} |

The session holds every head that was taken over, 0.2 MB each: that is what grows.

![Memory over edits](endurance.png)
"""
    )
    print(TABLE.read_text())


if __name__ == "__main__":
    main()
