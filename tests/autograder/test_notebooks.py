"""The built notebooks run top to bottom in a real kernel, every check passes, and figures are drawn."""

import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

from autograder.course import Course
from labsid.checks.notebook import assignment_names, load_assignment


@pytest.mark.parametrize("name", assignment_names())
def test_the_solution_runs_top_to_bottom(name: str, course: Course, tmp_path: Path) -> None:
    path = tmp_path / f"{name}.ipynb"
    shutil.copyfile(course.source / name / f"{name}.ipynb", path)
    record = load_assignment(name).record_file
    if record is not None:
        shutil.copyfile(course.data / record, tmp_path / record)
    command = [sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", "--inplace", path.name]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr[-2000:]
    outputs = [
        output
        for cell in nbformat.read(path, as_version=4).cells
        if cell.cell_type == "code"
        for output in cell.outputs
    ]
    printed = "".join(output.get("text", "") for output in outputs)
    for question in load_assignment(name).questions:
        assert f"✓ {question.id}:" in printed
    assert any("image/png" in output.get("data", {}) for output in outputs)
