"""The plan of the house holds: who may import whom, and what the package weighs."""

import subprocess
import sys
from pathlib import Path

from importlinter.cli import lint_imports

import sketchwidget

PACKAGE = Path(sketchwidget.__file__).parent
HEAVY = {"torch", "igl", "cv2", "ipywidgets", "ipycanvas", "pythreejs", "anywidget", "scipy", "trimesh", "skimage"}


def test_every_room_uses_only_the_floors_below(capsys):
    status = lint_imports(config_filename=str(PACKAGE.parent / "pyproject.toml"), no_cache=True)
    assert status == 0, capsys.readouterr().out


def test_import_is_light():
    code = f"import sys, sketchwidget; sys.exit(' '.join({HEAVY} & set(sys.modules)) or 0)"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.returncode == 0, f"import sketchwidget loads {result.stderr}"


def test_wheel_stays_small():
    """The wheel with its data is to hold 40 MB at most; most of it is data that does not compress."""
    files = [path for path in PACKAGE.rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    assert sum(path.stat().st_size for path in files) <= 40e6
