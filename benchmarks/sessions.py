"""Heads made by scripted sessions through all three modes, from a blank pad to an exported head (Figure 10, Table 1).

python -m benchmarks.sessions
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

import sketchwidget as sw
from sketchwidget.gesture.shapes import example
from sketchwidget.training.tables import machine

HERE = Path(__file__).parent
DRAWINGS = HERE.parent / "docs" / "freehand"
TABLE, GALLERY = HERE / "SESSIONS.md", HERE / "sessions.png"

MODES = {"initial": "initial sketching", "followup": "follow-up sketching", "refine": "gestures"}


class Artist:
    """Works on a session as a person would, and notes how long the kernel took in each mode."""

    def __init__(self, session: sw.Session) -> None:
        self.session = session
        self.edits: dict[str, int] = defaultdict(int)
        self.milliseconds: dict[str, float] = defaultdict(float)

    def note(self) -> None:
        """The last edit, in the mode that it was made in."""
        self.edits[self.session.mode] += 1
        self.milliseconds[self.session.mode] += self.session.timings["total"]

    def draw(self, drawing: str) -> None:
        """Draw a freehand drawing, stroke by stroke."""
        for segment in sw.Sketch.load(DRAWINGS / drawing).segments:
            self.session.draw(segment.points)
            self.note()

    def redraw(self, line: str, shift: tuple[float, float]) -> None:
        """Erase a piece of one of the head's lines and draw it anew, its middle shifted by canvas units."""
        points = self.session.sketch.lines[line][0]
        self.session.erase(points[len(points) // 2], radius=0.005)
        self.note()
        gap = self.session.gap
        assert gap is not None
        along = np.linspace(0, np.pi, len(gap.erased.points))[:, None]
        self.session.draw(gap.erased.points + np.sin(along) * np.array(shift))
        self.note()

    def place(self, landmark: int, view: str = "front") -> np.ndarray:
        """Where a landmark is seen."""
        frame = self.session.frame
        seen = sw.View(sw.View.preset(view).rotation, frame.scale, frame.centre)
        return seen.project(self.session.face.landmarks[landmark])

    def brush(self, landmark: int, radius: float, view: str = "front") -> None:
        """Mark the skin about a landmark, and nothing else."""
        if len(self.session.handles):
            self.session.brush(self.session.handles, erase=True)
            self.note()
        self.session.brush(self.session.under_brush([self.place(landmark, view)], radius, view))
        self.note()

    def gesture(self, points: np.ndarray, view: str = "front") -> None:
        """Draw a gesture."""
        self.session.gesture(points, view)
        self.note()


@dataclass(frozen=True)
class Script:
    """A session: a drawing, and what is done to its head.

    Parameters
    ----------
    name : str
    drawing : str
        A file of docs/freehand.
    follow_up, refine : callable
        What an `Artist` does in each mode.
    """

    name: str
    drawing: str
    follow_up: Callable[[Artist], None]
    refine: Callable[[Artist], None]

    def play(self, session: sw.Session) -> tuple[Artist, list[sw.Face]]:
        """Work on an empty session; the artist, and the head at the end of each mode."""
        artist, heads = Artist(session), []
        artist.draw(self.drawing)
        heads.append(session.face)
        for mode, act in (("followup", self.follow_up), ("refine", self.refine)):
            session.mode = mode
            act(artist)
            heads.append(session.face)
        return artist, heads


def _long_nose(artist: Artist) -> None:
    artist.brush(30, 0.02)
    artist.gesture(example("up roll 3", artist.place(30), 0.2))
    artist.gesture(np.linspace(artist.place(30), artist.place(30) + np.array([0, 0.03]), 20))
    artist.gesture(example("region", artist.place(8) - [0, 0.03], 0.34))
    artist.brush(8, 0.03)
    artist.gesture(example("up roll 2", artist.place(8), 0.2))


def _strong_chin(artist: Artist) -> None:
    artist.gesture(example("region", artist.place(8) - [0, 0.03], 0.36))
    artist.brush(8, 0.035)
    artist.gesture(np.linspace(artist.place(8), artist.place(8) + np.array([0, 0.05]), 20))
    artist.gesture(example("up roll 2", artist.place(8), 0.2))


def _snub_nose(artist: Artist) -> None:
    artist.brush(30, 0.02)
    artist.gesture(example("down roll 2", artist.place(30), 0.2))
    artist.gesture(np.linspace(artist.place(30), artist.place(30) - np.array([0, 0.05]), 20))
    artist.gesture(example("left arrow", [0.5, 0.5], 0.2))
    artist.gesture(np.linspace(artist.place(30), artist.place(30) - np.array([0, 0.015]), 20))
    artist.session.brush(artist.session.handles, erase=True)
    artist.note()
    root, middle = artist.place(27, "left"), artist.place(29, "left")
    artist.gesture(np.linspace(root + np.array([0.008, 0]), middle + np.array([0.012, 0]), 20), "left")


SCRIPTS = (
    Script("a long nose", "10_long_face_long_nose.json", lambda artist: artist.redraw("nose", (0, 0.012)), _long_nose),
    Script("a strong chin", "15_broad_grin.json", lambda artist: artist.redraw("left_brow", (0, -0.02)), _strong_chin),
    Script("a snub nose", "06_surprised.json", lambda artist: artist.redraw("mouth_lower", (0, 0.02)), _snub_nose),
)


def main() -> None:
    """Play the scripts; write the gallery and the table of timings beside this file."""
    regressor = sw.FaceRegressor.load()
    rows, pictures = [], []
    for script in SCRIPTS:
        session = sw.Session(regressor)
        artist, heads = script.play(session)
        drawing = sw.Sketch.load(DRAWINGS / script.drawing).picture(260)
        views = [heads[0].picture("three-quarter", 260), heads[1].picture("three-quarter", 260)]
        views += [heads[2].picture(view, 260) for view in ("three-quarter", "left", "front")]
        pictures.append(np.hstack([drawing, *views]))
        steps = [f"{artist.edits[mode]} | {artist.milliseconds[mode]:.0f} ms" for mode in MODES]
        rows.append(f"| {script.name} | {' | '.join(steps)} |")
    cv2.imwrite(str(GALLERY), np.vstack(pictures)[..., ::-1])
    lines = [
        "# Sessions through all three modes",
        "",
        "Edits, and what the kernel took for all of them: the counterpart of Table 1, whose minutes are people's.",
        f"Made by `python -m benchmarks.sessions` on: {machine()}.",
        "",
        "| session | " + " | ".join(f"edits in {name} | kernel" for name in MODES.values()) + " |",
        "|---|" + "---|" * 2 * len(MODES),
        *rows,
        "",
        "![Drawing; head after each mode; the finished head from the left and from the front](sessions.png)",
    ]
    TABLE.write_text("\n".join(lines) + "\n")
    print(TABLE.read_text())


if __name__ == "__main__":
    main()
