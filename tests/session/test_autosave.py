"""A session whose kernel is killed."""

import random
import signal
import subprocess
import sys
import time

import pytest

from sketchwidget.files import textfile
from sketchwidget.session import Session

KERNEL = """
import sys
from types import SimpleNamespace
from sketchwidget.geometry.view import View
from sketchwidget.session import Session

class Regressor:
    def infer(self, sketch):
        return SimpleNamespace(face=None, names=("wrinkle",) * len(sketch), frame=View(), timings={})

session = Session(Regressor())
session.autosave(sys.argv[1])
while True:
    session.draw([[0.2, 0.2], [0.4, 0.3 + 0.001 * (len(session.sketch) % 100)]])
    print(len(session.events), flush=True)
"""


@pytest.mark.parametrize("seed", range(3))
def test_a_killed_kernel_leaves_all_finished_strokes(seed, tmp_path, regressor):
    path = tmp_path / "drawing.jsonl"
    kernel = subprocess.Popen([sys.executable, "-c", KERNEL, path], stdout=subprocess.PIPE, text=True)
    assert kernel.stdout is not None and kernel.stdout.readline() == "1\n"
    time.sleep(random.Random(seed).uniform(0, 0.5))
    kernel.send_signal(signal.SIGKILL)
    finished = [1, *map(int, kernel.stdout.read().split())][-1]
    kernel.wait()
    events = len(Session.load(path, regressor).events)
    assert events in (finished, finished + 1)  # the next one may have been written, but not told


def test_what_is_undone_and_replaced_is_saved_too(tmp_path):
    path = tmp_path / "drawing.jsonl"
    session = Session(inference=False)
    session.autosave(path)
    piece = session.sketch.lines["left_brow"][0]
    session.erase(piece[len(piece) // 2])
    session.undo()
    session.exaggerate(1.2)
    session.exaggerate(1.5)  # takes the place of the one before
    assert path.read_text() == session.dumps()


def test_a_full_disk_is_told_and_loses_nothing(tmp_path, regressor, monkeypatch):
    session = Session(regressor)
    session.autosave(tmp_path / "drawing.jsonl")
    session.draw([[0.2, 0.2], [0.4, 0.3]])

    def full(*_):
        raise OSError("no space left")

    with monkeypatch.context() as patch:
        patch.setattr(textfile, "write", full)
        with pytest.raises(OSError, match="no space left"):
            session.draw([[0.2, 0.3], [0.4, 0.4]])
    assert len(session.sketch) == 2 and len(Session.load(tmp_path / "drawing.jsonl", regressor).events) == 1
    session.undo()
    assert (tmp_path / "drawing.jsonl").read_text() == session.dumps()


def test_a_session_in_place_of_another_saves_itself_where_that_did(tmp_path):
    session = Session(inference=False)
    session.autosave(tmp_path / "kept.jsonl")
    other = session.another(Session(inference=False).dumps())
    other.draw([[0.3, 0.3], [0.6, 0.7]])
    assert Session.load(tmp_path / "kept.jsonl").events == other.events
