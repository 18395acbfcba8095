"""A class: the load test with three pupils, and the image of a JupyterHub."""

import re
import sys
from pathlib import Path

import psutil

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from benchmarks import hub  # noqa: E402


def test_pupils_are_added_and_answered_and_no_kernel_stays(monkeypatch):
    monkeypatch.setattr(hub, "PEN_SPEED", 5.0)
    before = {child.pid for child in psutil.Process().children(recursive=True)}
    one, three = hub.measure((1, 3), edits=3, thinking=(0.0, 0.1))
    assert (one.pupils, three.pupils) == (1, 3)
    assert len(one.answered) == 2 and len(three.answered) == 3 + 2 + 2  # a new pupil begins afresh
    assert (three.answered > 0).all() and one.cpu > 0 and three.busy > 0
    assert 100 < one.proportional <= one.resident and one.proportional < three.proportional < three.resident
    assert {child.pid for child in psutil.Process().children(recursive=True)} <= before


def test_without_memory_to_spare_no_kernel_is_started(monkeypatch):
    monkeypatch.setattr(hub, "SPARE_MB", 1e9)
    assert hub.measure((1,)) == []


def test_the_image_has_binders_python_and_copies_what_is_there():
    image = (ROOT / "binder" / "hub" / "Dockerfile").read_text()
    (python,) = re.findall(r"^FROM python:([\d.]+)-slim$", image, re.MULTILINE)
    assert (ROOT / "binder" / "runtime.txt").read_text().strip() == f"python-{python}"
    copied = " ".join(re.findall(r"^COPY (?:--\S+ )?(.*) \S+$", image, re.MULTILINE)).split()
    assert "sketchwidget" in copied and [name for name in copied if not (ROOT / name).exists()] == []
    pins = (ROOT / "binder" / "hub" / "requirements.txt").read_text().splitlines()
    assert "-r ../requirements.txt" in pins
    assert all("==" in pin for pin in pins if not pin.startswith(("#", "-r ")))
