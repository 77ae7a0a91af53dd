"""A released course, and a notebook that is edited, saved and run cell by cell in a kernel, as in JupyterLab."""

import json
import re
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import nbformat
import pytest
from course_work import copy_course

from autograder.course.build import build_course
from autograder.course.layout import Course
from labsid.hand_in.kernel import NotebookKernel

PRELAB, LAB, POSTLAB = "prelab-sinusoids", "lab-identification", "postlab-model-order"


@pytest.fixture(scope="session")
def released(tmp_path_factory: pytest.TempPathFactory) -> Course:
    """A course of three assignments, built."""
    course = copy_course(tmp_path_factory.mktemp("course"), PRELAB, LAB, POSTLAB)
    list(build_course(course))
    return course


@pytest.fixture(autouse=True)
def installed_release(released: Course, monkeypatch: pytest.MonkeyPatch) -> None:
    """The release of that course takes the place of the one on this machine."""
    monkeypatch.setattr("labsid.checks.notebook_file.release_folder", lambda: released.release)


@dataclass
class JupyterNotebook:
    """A notebook open in JupyterLab: its saved file, and a kernel that is told the id of each cell."""

    path: Path
    kernel: NotebookKernel
    cells: list[dict[str, Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.cells = json.loads(self.path.read_text(encoding="utf-8"))["cells"]

    def cell(self, cell_id: str) -> dict[str, Any]:
        return next(cell for cell in self.cells if cell["id"] == cell_id)

    def edit(self, cell_id: str, source: str, save: bool = True) -> None:
        self.cell(cell_id)["source"] = source
        if save:
            self.save()

    def add(self, after: str, cell_id: str, source: str, save: bool = True) -> None:
        place = next(i for i, cell in enumerate(self.cells) if cell["id"] == after) + 1
        new = {"cell_type": "code", "id": cell_id, "metadata": {}, "source": source, "outputs": []}
        self.cells.insert(place, new)
        if save:
            self.save()

    def delete(self, cell_id: str) -> None:
        self.cells.remove(self.cell(cell_id))
        self.save()

    def save(self) -> None:
        content = {"cells": self.cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}
        self.path.write_text(json.dumps(content), encoding="utf-8")

    def run(self, *cell_ids: str, seconds: float = 20) -> str:
        """Run cells; what the last one showed: what it printed, or its error."""
        shown = ""
        for cell_id in cell_ids:
            done = self.kernel.run("".join(self.cell(cell_id)["source"]), cell_id, seconds)
            shown = f"✗ {done.text}" if done.error == "CheckFailed" else f"{done.error}: {done.text}"
            shown = shown if done.error else done.printed
        return shown.strip()

    def answer(self, question: str, source: str) -> str:
        """Write, save and run an answer, then run its check."""
        self.edit(f"{question}-answer", source)
        return self.run(f"{question}-answer", question)


@pytest.fixture
def jupyter(released: Course, tmp_path: Path) -> Iterator[JupyterNotebook]:
    """The pre-lab, open, with its first cell run."""
    folder = tmp_path / "work" / PRELAB
    shutil.copytree(released.release / PRELAB, folder)
    with NotebookKernel(folder) as kernel:
        notebook = JupyterNotebook(folder / f"{PRELAB}.ipynb", kernel)
        notebook.run("prelab-setup")
        yield notebook


Solve = Callable[..., Path]


@pytest.fixture
def solve(released: Course, tmp_path: Path) -> Solve:
    """Write a solved notebook into the work folder, some of its answers replaced or, where None, left open."""

    def write(name: str, **replaced: str | None) -> Path:
        folder = tmp_path / "work" / name
        shutil.copytree(released.release / name, folder)
        source = nbformat.read(released.source / name / f"{name}.ipynb", as_version=4)
        texts = {cell.id: re.sub(r" *### (BEGIN|END) SOLUTION\n?", "", cell.source) for cell in source.cells}
        texts |= {key.replace("_", "-"): text for key, text in replaced.items()}
        path = folder / f"{name}.ipynb"
        notebook = nbformat.read(path, as_version=4)
        for cell in notebook.cells:
            if cell.metadata.get("nbgrader", {}).get("solution") and texts[cell.id] is not None:
                cell.source = texts[cell.id]
        nbformat.write(notebook, path)
        return path

    return write
