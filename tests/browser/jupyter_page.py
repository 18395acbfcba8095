"""Jupyter servers in temporary directories, and a Chromium that opens notebooks in them."""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import nbformat
from playwright.sync_api import Browser, Page, Playwright

ROOT = Path(__file__).resolve().parents[2]
DEADLINE = float(os.environ.get("BROWSER_DEADLINE", 120))  # seconds, for two busy cores
FLAGS = [
    "--headless=new",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-unsafe-swiftshader",
]


def launch_chromium(playwright: Playwright, *flags: str) -> Browser:
    """A headless Chromium: the system's, or else Playwright's own; RuntimeError if there is none."""
    names = ("chromium", "chromium-browser", "google-chrome")
    system = next((path for path in map(shutil.which, names) if path), None)
    own = playwright.chromium.executable_path
    if system is None and not Path(own).exists():
        raise RuntimeError("no Chromium on this machine: `make test` installs one (playwright install chromium)")
    return playwright.chromium.launch(
        executable_path=system or own, args=[*FLAGS, *flags], ignore_default_args=["--headless"]
    )


def write_notebook(folder: Path, name: str, *cells: str) -> str:
    """Write a notebook of code cells; its name with the suffix."""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    notebook.metadata.kernelspec = {"name": "python3", "display_name": "Python 3", "language": "python"}
    nbformat.write(notebook, folder / f"{name}.ipynb")
    return f"{name}.ipynb"


@contextmanager
def serve(kind: str, folder: Path, *options: str) -> Iterator[str]:
    """Run ``lab``, ``notebook`` or ``voila`` on a folder of notebooks and give its address, while the context lasts."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    settings = folder / ".settings"
    quiet = settings / "@jupyterlab" / "apputils-extension" / "notification.jupyterlab-settings"
    quiet.parent.mkdir(parents=True, exist_ok=True)
    quiet.write_text(json.dumps({"fetchNews": "false", "checkForUpdates": False}))
    environment = os.environ | {
        "JUPYTERLAB_SETTINGS_DIR": str(settings),
        "JUPYTERLAB_WORKSPACES_DIR": str(folder / ".workspaces"),
        "JUPYTER_CONFIG_DIR": str(folder / ".config"),
        "JUPYTER_RUNTIME_DIR": str(folder / ".runtime"),
        "IPYTHONDIR": str(folder / ".ipython"),
        "XDG_STATE_HOME": str(folder / ".state"),
        "PYTHONPATH": os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")])),
    }
    jupyter = ["--no-browser", "--allow-root", f"--port={port}", "--ServerApp.port_retries=0"]
    jupyter += [f"--ServerApp.root_dir={folder}", "--IdentityProvider.token="]
    command = {
        "lab": ["jupyterlab", *jupyter, "--LabApp.expose_app_in_browser=True"],
        "notebook": ["notebook", *jupyter, "--JupyterNotebookApp.expose_app_in_browser=True"],
        "voila": ["voila", str(folder), "--no-browser", f"--port={port}", "--Voila.port_retries=0"],
    }[kind]
    address = f"http://127.0.0.1:{port}"
    with open(folder / f"{kind}.log", "ab") as log:
        server = subprocess.Popen(
            [sys.executable, "-m", *command, *options], cwd=folder, env=environment, stdout=log, stderr=log
        )
    try:
        _wait_for(address if kind == "voila" else f"{address}/api", server, folder / f"{kind}.log")
        yield address
    finally:
        server.terminate()
        try:
            server.wait(20)
        except subprocess.TimeoutExpired:
            server.kill()
            server.wait()


def _wait_for(address: str, server: subprocess.Popen[bytes], log: Path) -> None:
    deadline = time.monotonic() + DEADLINE
    while time.monotonic() < deadline and server.poll() is None:
        try:
            urllib.request.urlopen(address, timeout=5).close()
            return
        except (urllib.error.URLError, OSError):
            time.sleep(0.2)
    raise RuntimeError(f"no answer from {address}:\n{log.read_text()[-4000:]}")


def open_in_lab(page: Page, address: str, notebook: str, run: bool = True) -> None:
    """Open a notebook in JupyterLab, and run it once its kernel is idle."""
    page.goto(f"{address}/doc/tree/{notebook}")
    _run_when_idle(page, run)


def open_in_notebook(page: Page, address: str, notebook: str) -> None:
    """Open a notebook in Notebook 7, and run it once its kernel is idle."""
    page.goto(f"{address}/notebooks/{notebook}")
    _run_when_idle(page, run=True)


def _run_when_idle(page: Page, run: bool) -> None:
    idle = """() => {
        const panel = window.jupyterapp?.shell.currentWidget;
        const kernel = panel?.sessionContext?.session?.kernel;
        return panel?.revealed && kernel?.connectionStatus === 'connected' && kernel?.status === 'idle';
    }"""
    page.wait_for_function(idle, timeout=1000 * DEADLINE)
    if run:
        page.evaluate("() => { window.jupyterapp.commands.execute('notebook:run-all-cells'); }")


def open_in_voila(page: Page, address: str, notebook: str) -> None:
    """Open a notebook in Voila, which runs it."""
    page.goto(f"{address}/voila/render/{notebook}", timeout=1000 * DEADLINE)
