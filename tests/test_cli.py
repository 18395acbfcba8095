"""The `sketchwidget` command."""

import json
import os
import re
import socket
import subprocess
import sys
import time
import urllib.request
from importlib.util import find_spec

import nbformat
import pytest
from typer.testing import CliRunner

import sketchwidget
from sketchwidget import cli

ONE_CELL = "sketchwidget-studio.ipynb"


def run(*arguments):
    result = CliRunner().invoke(cli.main, list(arguments))
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


@pytest.fixture
def elsewhere(monkeypatch, tmp_path):
    """The package as if installed from a wheel: no checkout around it."""
    monkeypatch.setattr(cli, "__file__", str(tmp_path / "site-packages" / "sketchwidget" / "cli.py"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def test_version_is_the_package_s():
    result = run("--version")
    assert result.exit_code == 0
    assert result.stdout.strip() == f"sketchwidget {sketchwidget.__version__}"


def test_help_lists_the_commands():
    result = run("--help")
    assert result.exit_code == 0
    assert "studio" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["sculpt"], "No such command"),
        (["studio", "--nose"], "No such option"),
        (["studio", "--port", "eighty"], "Invalid value for '--port'"),
        (["studio", "--port", "0"], "Invalid value for '--port'"),
        (["studio", "--port", "65536"], "Invalid value for '--port'"),
        (["studio", "--host", "no such host"], "cannot listen on no such host"),
    ],
)
def test_bad_use_ends_with_a_message(arguments, complaint):
    result = run(*arguments)
    assert result.exit_code != 0
    assert complaint in " ".join(result.stderr.split())
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize(
    ("arguments", "within", "goes_on"),
    [
        (["database", "--preset", "tiny", "--out", "faces"], "database.build.build", True),
        (["train", "network", "faces", "--out", "network"], "training.commands._pipeline", True),
        (["train", "portraits", "--out", "portraits"], "face.model.FaceModel.load", True),
        (["train", "face", "faces", "--out", "face"], "database.database.FaceDatabase.open", False),
        (["train", "avatar", "--out", "avatar"], "training.avatar_template.build_template", False),
        (["train", "gestures", "--out", "gestures"], "training.gestures.train", False),
        (["evaluate", "faces"], "training.commands._pipeline", False),
    ],
)
def test_a_command_that_is_stopped_says_whether_it_goes_on(monkeypatch, tmp_path, arguments, within, goes_on):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(f"sketchwidget.{within}", interrupted)
    result = run(*arguments)
    assert result.exit_code == 130
    kept = "; the same command goes on from what is finished" if goes_on else ""
    assert result.stderr == f"sketchwidget: stopped{kept}\n"


def test_port_in_use_ends_with_a_message():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        number = taken.getsockname()[1]
        result = run("studio", "--port", str(number))
    assert result.exit_code == 1
    assert f"port {number}" in result.stderr
    assert "--port" in result.stderr


@pytest.mark.parametrize(("option", "package"), [([], "jupyterlab"), (["--app"], "voila")])
def test_missing_extra_is_named(monkeypatch, elsewhere, option, package):
    monkeypatch.setattr(cli, "find_spec", lambda name: None if name == package else find_spec(name))
    result = run("studio", *option)
    assert result.exit_code == 1
    assert package in result.stderr
    assert "pip install 'sketchwidget[notebooks]'" in result.stderr
    assert not (elsewhere / ONE_CELL).exists()


def test_installed_package_writes_a_one_cell_notebook(elsewhere):
    notebook = nbformat.read(cli.studio_notebook(elsewhere), as_version=4)
    nbformat.validate(notebook)
    assert [cell.source for cell in notebook.cells] == ["import sketchwidget as sw\n\nsw.Studio()"]


def test_the_page_is_the_studio_alone_and_leaves_nothing_behind(monkeypatch, elsewhere, port):
    served = {}
    monkeypatch.setattr(cli, "_serve_page", lambda path, *_: served.update({path: nbformat.read(path, as_version=4)}))
    assert run("studio", "--app", "--port", str(port)).exit_code == 0
    ((path, notebook),) = served.items()
    assert [cell.source for cell in notebook.cells] == ["import sketchwidget as sw\n\nsw.Studio()"]
    assert not path.exists() and not any(elsewhere.iterdir())


def test_a_notebook_already_there_is_kept(elsewhere):
    (elsewhere / ONE_CELL).write_text("mine")
    assert cli.studio_notebook(elsewhere).read_text() == "mine"


def test_a_folder_that_cannot_be_written_ends_with_a_message(monkeypatch, elsewhere, port):
    (elsewhere / "gone").mkdir()
    monkeypatch.chdir(elsewhere / "gone")
    (elsewhere / "gone").rmdir()
    result = run("studio", "--port", str(port))
    assert result.exit_code == 1
    assert result.stderr.startswith("sketchwidget: cannot")


def test_help_does_not_load_the_heavy_libraries():
    code = (
        "import sys; from sketchwidget.cli import main; main(['--help'], standalone_mode=False);"
        "sys.exit(' '.join({'torch', 'igl', 'cv2', 'ipywidgets', 'jupyterlab', 'numpy'} & set(sys.modules)) or 0)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)


def test_studio_answers_at_the_address_it_prints(tmp_path, port):
    """The token lets in to the notebook; without it the server asks to log in."""
    private = {f"JUPYTER_{name}_DIR": str(tmp_path / name) for name in ("CONFIG", "DATA", "RUNTIME")}
    command = [sys.executable, "-m", "sketchwidget", "studio", "--port", str(port)]
    with (
        open(tmp_path / "output", "w+") as output,
        subprocess.Popen(
            command, cwd=tmp_path, env=os.environ | private, stdin=subprocess.DEVNULL, stdout=output, stderr=output
        ) as server,
    ):
        try:
            address = wait_for_address(tmp_path / "output", server)
            assert f"http://127.0.0.1:{port}/lab/tree/" in address
            with urllib.request.urlopen(address, timeout=30) as page:
                assert page.status == 200
                assert "/login" not in page.url
                config = re.search(r'id="jupyter-config-data"[^>]*>(.*?)</script>', page.read().decode(), re.DOTALL)
                assert config and json.loads(config[1])["news"] == {"disabled": True}  # no question over the Studio
            name = address.split("/lab/tree/")[1]
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/contents/{name}", timeout=30) as page:
                assert any("sw.Studio()" in cell["source"] for cell in json.load(page)["content"]["cells"])
            with urllib.request.urlopen(address.split("?")[0], timeout=30) as page:
                assert "/login" in page.url
        finally:
            server.terminate()


def wait_for_address(output, server):
    """The address that the server prints, waited for."""
    for _ in range(600):
        if found := re.search(r"The studio is at\s+(\S+)", output.read_text()):
            return found[1]
        assert server.poll() is None, output.read_text()
        time.sleep(0.1)
    raise AssertionError(f"no address within a minute:\n{output.read_text()}")
