"""Every public name has an example in its docstring, and the example is true."""

import doctest
import inspect

import numpy as np
import pytest

import sketchwidget as sw
from sketchwidget.session import behaviours


def example_of(name):
    """The example that shows a public name: its own, or for plain data the package's."""
    thing = getattr(sw, name)
    told = inspect.getdoc(thing if callable(thing) or inspect.ismodule(thing) else sw)
    return doctest.DocTestParser().get_doctest(told, {"sw": sw, "np": np}, name, None, 0)


@pytest.fixture
def elsewhere(request, monkeypatch, tmp_path, lines_restored):
    """A folder of its own, for the example of a database with one in it; what is registered is forgotten again."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(behaviours, "_BEHAVIOURS", dict(behaviours._BEHAVIOURS))
    if request.node.callspec.params["name"] == "FaceDatabase":
        (tmp_path / "faces").symlink_to(request.getfixturevalue("small_folder"), target_is_directory=True)


@pytest.mark.parametrize("name", sw.__all__)
def test_the_example_of_a_public_name_runs(name, elsewhere):
    example = example_of(name)
    assert any(f"sw.{name}" in line.source for line in example.examples), f"{name} has no example that uses it"
    told = []
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example, out=told.append)
    assert not told, "".join(told)
