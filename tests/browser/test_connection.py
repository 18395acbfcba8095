"""A Studio whose kernel ends while people draw in it."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from studio_page import OVAL, StudioPage, until

import sketchwidget as sw

CODE = "import os\nfrom pathlib import Path\nPath({name!r}).write_text(str(os.getpid()))\nsw.Studio()"
RESTART = "() => { window.jupyterapp.shell.currentWidget.sessionContext.session.kernel.restart(); }"


def drawn(studio: StudioPage) -> StudioPage:
    before = studio.serial
    studio.draw(OVAL)
    studio.wait_for_frame(before)
    until(lambda: studio.message, lambda said: said.startswith("Stroke drawn"), "the word of the stroke")
    return studio


def farewell(studio: StudioPage) -> str:
    line = studio.root.locator(".sketchwidget-farewell")
    until(line.is_visible, what="the word of the kernel's end")
    assert studio.root.locator(".sketchwidget-status").is_hidden()
    return line.inner_text()


@pytest.mark.parametrize("kind", ["lab", "voila"])
def test_a_studio_whose_kernel_died_says_so_and_what_was_drawn_comes_back(
    open_studio: Callable[..., StudioPage], servers: Callable[..., tuple[str, Path]], kind: str
) -> None:
    studio = drawn(open_studio(kind, code=CODE.format(name=f"{kind}.pid")))
    assert studio.root.locator(".sketchwidget-farewell").is_hidden()
    os.kill(int((servers(kind)[1] / f"{kind}.pid").read_text()), signal.SIGKILL)
    said = farewell(studio)
    assert said.startswith("The kernel has ended") and studio.ink_pixels()
    path = re.search(r'sw\.Studio\(sw\.Session\.load\("(.+)"\)\)', said)
    assert path is not None
    again = sw.Session.load(path[1])
    assert len(again.events) == 1 and set(again.sketch.lines) == {"silhouette"}


def test_a_restarted_kernel_is_told_and_the_cell_gives_a_new_studio(open_studio: Callable[..., StudioPage]) -> None:
    studio = drawn(open_studio("lab"))
    studio.page.evaluate(RESTART)
    farewell(studio)
    until(
        lambda: studio.page.evaluate("window.jupyterapp.shell.currentWidget.sessionContext.session.kernel.status"),
        lambda status: status == "idle",
        "the kernel",
    )
    studio.page.evaluate("() => { window.jupyterapp.commands.execute('notebook:run-all-cells'); }")
    until(lambda: studio.root.locator(".sketchwidget-farewell").is_hidden(), what="a new Studio")
    studio.wait_until_shown()
    drawn(studio)
