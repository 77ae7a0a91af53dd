"""The repository's own course in another place, for tests and measurements: copied, graded by the cell, executed.

And what a graded class has in its gradebook.
"""

import os
import shutil
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

from autograder.batch.grading_inputs import DataStore, GradingInputs, inputs_for
from autograder.course.build import build_course
from autograder.course.layout import Course, read_template
from autograder.course.nbgrader_access import open_gradebook
from autograder.intake.submission import NotebookCell, Submission
from autograder.judge.judging import judge_submission
from autograder.judge.outcome import QuestionResult
from autograder.results.gradebook import database_url
from autograder.sandbox.isolation import ProcessLauncher
from labsid.checks.cells import Template
from labsid.checks.notebook import load_assignment
from labsid.records.record import load_record

ROOT = Path(__file__).resolve().parent.parent


def copy_course(root: Path, *names: str) -> Course:
    """The text notebooks (all, or those named) and the data in a folder of their own, not built yet."""
    for name in names or (".",):
        shutil.copytree(ROOT / "notebooks" / name, root / "notebooks" / name)
    shutil.copytree(ROOT / "data", root / "data")
    (root / "autograder").mkdir(parents=True)
    return Course(root)


def shared_folder(factory: pytest.TempPathFactory) -> Path:
    """The folder of a test session that all its workers share."""
    base = factory.getbasetemp()
    return base.parent if "PYTEST_XDIST_WORKER" in os.environ else base


def built_course(root: Path, shared: Path) -> Course:
    """The whole course, built by the first process that asks for it and copied from `shared` by the others."""
    made = shared / "built-course"
    deadline = time.monotonic() + 300
    try:
        (shared / "building-course").mkdir()
    except FileExistsError:
        while not made.is_dir():
            if time.monotonic() > deadline:
                raise TimeoutError("another process has not built the course") from None
            time.sleep(0.1)
    else:
        course = copy_course(shared / "building-course" / "course")
        assert list(build_course(course)) == course.assignments()
        course.root.rename(made)
    shutil.copytree(made, root, dirs_exist_ok=True)
    return Course(root)


@cache
def read_solved(course: Course, name: str) -> tuple[Template, Mapping[str, str]]:
    """An assignment of a built course, and the source of each of its cells with the model solution."""
    source = nbformat.read(course.source / name / f"{name}.ipynb", as_version=4)
    return read_template(course, name), {cell.id: cell.source for cell in source.cells}


@cache
def shared_inputs(course: Course, name: str) -> GradingInputs:
    """What a submission is graded with where everybody works on the course's own record."""
    return inputs_for(DataStore(course, None, course.root), read_solved(course, name)[0], "s")


@dataclass(frozen=True)
class GradeCode:
    """Grade the model solution with some cells replaced: ``grade_code(assignment, {cell id: source}, record=path)``."""

    course: Course
    launcher: ProcessLauncher
    second_record: bool = True

    def __call__(
        self, name: str, replaced: Mapping[str, str], record: Path | None = None, student: str = "s"
    ) -> dict[str, QuestionResult]:
        template, solution = read_solved(self.course, name)
        texts = {**solution, **replaced}
        unknown = set(replaced) - {cell.id for cell in template.cells}
        assert not unknown, f"{name} has no cells {unknown}"
        steps = tuple(
            NotebookCell(
                cell.id, cell.kind, texts[cell.id] if cell.kind in ("answer", "manual") else cell.source, cell.code
            )
            for cell in template.cells
        )
        inputs = shared_inputs(self.course, name)
        assets = replace(inputs.assets, second_record=self.second_record)
        assets = assets if record is None else replace(assets, record=load_record(record))
        with tempfile.TemporaryDirectory() as bench:
            for file, path in inputs.files.items():
                shutil.copyfile(record or path, Path(bench) / file)
            submission = Submission(student, name, "ready", steps, ())
            result = judge_submission(submission, assets, self.launcher, Path(bench), pictures=False)
        return {question.question: question for question in result.results}


def execute_solution(course: Course, name: str, folder: Path) -> Any:
    """Run a solution notebook top to bottom in a real kernel; the notebook with its outputs and the time of each cell.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        If a cell fails.
    """
    folder.mkdir(parents=True, exist_ok=True)
    record = load_assignment(name).record_file
    if record is not None:
        shutil.copyfile(course.data / record, folder / record)
    notebook = nbformat.read(course.source / name / f"{name}.ipynb", as_version=4)
    client = NotebookClient(notebook, kernel_name="python3", resources={"metadata": {"path": str(folder)}})
    return client.execute()


def scores_in_gradebook(out: Path) -> dict[tuple[str, str, str], tuple[float | None, float, bool]]:
    """Score, marks and whether it waits for a hand, by student, assignment and question: as nbgrader reads them."""
    with open_gradebook(database_url(out)) as book:
        return {
            (submission.student.id, assignment.name, grade.name): (
                grade.auto_score, grade.max_score, grade.needs_manual_grade
            )
            for assignment in book.assignments
            for submission in assignment.submissions
            for notebook in submission.notebooks
            for grade in notebook.grades
        }  # fmt: skip


def give_by_hand(out: Path, assignment: str, student: str, question: str, comment: str = "", **scores: float) -> None:
    """Grade by hand, as formgrader does it: through nbgrader's own interface."""
    with open_gradebook(database_url(out)) as book:
        grade = book.find_grade(question, assignment, assignment, student)
        for field, score in scores.items():
            setattr(grade, field, score)
        if scores:
            grade.needs_manual_grade = False
        if comment:
            book.find_comment(question, assignment, assignment, student).manual_comment = comment
        book.db.commit()
