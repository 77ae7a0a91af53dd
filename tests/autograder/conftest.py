"""A course built once a session in a folder of its own, a workshop, and a way to grade code without a batch."""

import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import nbformat
import pytest

from autograder.assets import Stock, desk_for
from autograder.build import build_course
from autograder.course import Course, read_template
from autograder.intake import Step, Submission
from autograder.isolation import Limits, Workshop, open_workshop
from autograder.judge import QuestionResult, judge_submission
from labsid.record import load_record

ROOT = Path(__file__).resolve().parent.parent.parent

GradeCode = Callable[..., dict[str, QuestionResult]]


@pytest.fixture(scope="session")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    """The repository's own course, built apart from it."""
    root = tmp_path_factory.mktemp("course")
    shutil.copytree(ROOT / "notebooks", root / "notebooks")
    shutil.copytree(ROOT / "data", root / "data")
    (root / "autograder").mkdir()
    built = Course(root)
    assert list(build_course(built)) == built.assignments()
    return built


@pytest.fixture(scope="session")
def workshop() -> Iterator[Workshop]:
    """Starts students' processes, with short limits."""
    with open_workshop(limits=Limits(cell_seconds=20, call_seconds=10)) as opened:
        yield opened


@pytest.fixture(scope="session")
def grade_code(course: Course, workshop: Workshop) -> GradeCode:
    """Grade the model solution with some cells replaced: ``grade_code(assignment, {cell id: source}, record=path)``."""

    def grade(
        name: str, replaced: Mapping[str, str], record: Path | None = None, student: str = "s"
    ) -> dict[str, QuestionResult]:
        template = read_template(course, name)
        source = nbformat.read(course.source / name / f"{name}.ipynb", as_version=4)
        texts = {cell.id: cell.source for cell in source.cells} | dict(replaced)
        unknown = set(replaced) - {cell.id for cell in template.cells}
        assert not unknown, f"{name} has no cells {unknown}"
        steps = tuple(
            Step(cell.id, cell.kind, texts[cell.id] if cell.kind in ("answer", "manual") else cell.source, cell.code)
            for cell in template.cells
        )
        desk = desk_for(Stock(course, None, course.root), template, student)
        assets = desk.assets if record is None else replace(desk.assets, record=load_record(record))
        with tempfile.TemporaryDirectory() as bench:
            for file, path in desk.files.items():
                shutil.copyfile(record or path, Path(bench) / file)
            submission = Submission(student, name, "ready", steps, ())
            result = judge_submission(submission, assets, workshop, Path(bench), pictures=False)
        return {question.question: question for question in result.results}

    return grade
