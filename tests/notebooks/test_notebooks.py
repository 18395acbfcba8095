"""Every notebook runs from top to bottom, its folded solutions too, and is committed as it ran."""

import re
import textwrap
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

FOLDER = Path(__file__).parents[2] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_runs_from_top_to_bottom(path, tmp_path, monkeypatch):
    monkeypatch.setenv("TRAINING_STEPS", "50")  # a notebook that trains shows with so many that it runs
    notebook = nbformat.read(path, as_version=4)
    notebook.cells += map(nbformat.v4.new_code_cell, solutions(notebook.cells[-1].source))
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()


def solutions(text: str) -> list[str]:
    """The blocks of code in the folded part of an exercise's text."""
    folded = text.partition("<details>")[2]
    return [textwrap.dedent(block) for block in re.findall(r"```python\n(.*?)^ *```", folded, re.MULTILINE | re.DOTALL)]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_is_committed_with_its_outputs(path):
    notebook = nbformat.read(path, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    assert not [output for cell in code for output in cell.outputs if output.output_type == "error"]
    assert path.stat().st_size < 2e6


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_has_aims_formulas_pictures_exercises_and_what_comes_of_them(path):
    notebook = nbformat.read(path, as_version=4)
    first, *texts = [cell.source for cell in notebook.cells if cell.cell_type == "markdown"]
    assert first.startswith("# ") and "**Aims.** After it you can" in first and re.search("[Rr]uns in", first)
    assert any(re.search(r"\$[^$]+\$", text) for text in texts)
    kinds = {kind for cell in notebook.cells for output in cell.get("outputs", []) for kind in output.get("data", {})}
    assert kinds & {"image/png", "image/jpeg"}
    *_, last = texts
    exercises, _, folded = last.partition("## Try it")[2].partition("<details><summary>")
    assert "</details>" in folded and folded.startswith(("Solutions", "Hints"))
    numbers = [re.findall(r"^(\d)\. ", part, re.MULTILINE) for part in (exercises, folded)]
    assert len(numbers[0]) >= 3 and numbers[0] == numbers[1]


def test_the_readme_lists_the_course_in_order():
    readme = (FOLDER.parent / "README.md").read_text()
    assert re.findall(r"^- `(\d\d_\w+\.ipynb)`:", readme, re.MULTILINE) == [path.name for path in NOTEBOOKS]
