"""What the README shows runs as it stands: the blocks of a chapter one after the other, in a folder of its own."""

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from skimage import data

from sketchwidget.portrait.models import missing
from sketchwidget.session import behaviours
from sketchwidget.widgets.commands import COMMANDS

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
ELSEWHERE = ("ict-faces", "tcp://scheduler", "my-faces")  # what takes a clone of ICT-FaceKit, a cluster, a training
CHAPTERS = {
    chapter.partition("\n")[0]: blocks
    for chapter in re.split(r"^## ", README, flags=re.MULTILINE)[1:]
    if (
        blocks := [
            code
            for code in re.findall(r"^```python\n(.*?)^```", chapter, re.MULTILINE | re.DOTALL)
            if not any(name in code for name in ELSEWHERE)
        ]
    )
}


@pytest.fixture
def elsewhere(monkeypatch, tmp_path, small_folder):
    """A folder with what the README takes to be there; what is registered is forgotten again."""
    (tmp_path / "faces").symlink_to(small_folder, target_is_directory=True)
    Image.fromarray(data.astronaut()).save(tmp_path / "me.jpg")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(behaviours, "_BEHAVIOURS", dict(behaviours._BEHAVIOURS))


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_the_code_of_a_chapter_runs(chapter, elsewhere):
    if "me.jpg" in "".join(CHAPTERS[chapter]) and missing():
        pytest.skip("the models that find faces are not here")
    known = {}
    for code in CHAPTERS[chapter]:
        exec(compile(code, f"README.md, {chapter}", "exec"), known)
    for head in (known[name] for name in ("session", "fit") if name in known):
        assert np.isfinite(head.face.vertices).all()


def test_there_is_code_for_every_part_of_the_toolkit():
    assert len(CHAPTERS) >= 4


def test_every_key_of_the_studio_is_told():
    table = README[README.index("| tabs |") : README.index("| pictures |") + 300]
    of_the_collectors = {"keep", "skip", "pass"}
    for command in COMMANDS.values():
        key = command.tooltip.rpartition("(")[2].rstrip(")")
        assert command.name in of_the_collectors or f"`{key}`" in table, command
