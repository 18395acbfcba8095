"""Asks a server, as the badge does, for the page of the Studio: the notebook runs and shows a widget."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from urllib.error import URLError
from urllib.request import Request, urlopen

BINDER = Path(__file__).resolve().parent
TOKEN, PATIENCE = "binder", 120  # seconds


def serve(runtime: Path) -> subprocess.Popen[bytes]:
    """A JupyterLab on this checkout, at a free port of this machine, that writes its address into `runtime`."""
    root = "--allow-root" if getattr(os, "geteuid", lambda: 1)() == 0 else "--ServerApp.allow_root=False"
    command = [sys.executable, "-m", "jupyter", "lab", "--no-browser", "--ip=127.0.0.1", "--port=0", root]
    command += [f"--IdentityProvider.token={TOKEN}", f"--ServerApp.root_dir={BINDER.parent}"]
    where = {**os.environ, "JUPYTER_RUNTIME_DIR": str(runtime)}
    return subprocess.Popen(command, env=where, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def page(runtime: Path) -> str:
    """The page at which the badge points, once the server is there."""
    headers = {"Authorization": f"token {TOKEN}"}
    ends = time.monotonic() + PATIENCE
    while True:
        try:
            address = json.loads(next(runtime.glob("jpserver-*.json")).read_text())["url"]
            request = Request(f"{address}voila/render/binder/studio.ipynb", headers=headers)
            with urlopen(request, timeout=PATIENCE) as answer:
                return answer.read().decode()
        except (StopIteration, URLError, json.JSONDecodeError):
            if time.monotonic() > ends:
                raise
            time.sleep(0.5)


with tempfile.TemporaryDirectory() as folder:
    server = serve(Path(folder))
    try:
        shown = page(Path(folder))
    finally:
        server.terminate()
        server.wait(30)
assert "application/vnd.jupyter.widget-view+json" in shown, "the page that the badge opens shows no widget"
print(f"the Studio's page: {len(shown) / 1000:.0f} kB")
