"""Grading a whole class: intake, judging in parallel, one writer."""

import hashlib
import inspect
import os
import shutil
import tempfile
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

import numpy
import scipy

import labsid
from autograder import gradebook, results
from autograder.build import template_hash
from autograder.course import Course, Template, read_template
from autograder.intake import take_in
from autograder.isolation import Workshop
from autograder.judge import Assets, SubmissionResult, judge_submission
from labsid.checks.notebook import load_assignment
from labsid.record import Record, load_record

PUBLIC_SECRET = b"labsid: inputs of functions under test"
"""Seeds the inputs on which functions are tried in a course that has no secret of its own."""


@dataclass(frozen=True, slots=True)
class Graded:
    """One submission that is done.

    Attributes
    ----------
    student, assignment : str
    fresh : bool
        False where the result of an earlier run was still good.
    """

    student: str
    assignment: str
    fresh: bool


@dataclass(frozen=True, slots=True)
class Batch:
    """What there is to grade.

    Attributes
    ----------
    submitted : Path
    students : tuple of str
    assignments : tuple of str
    """

    submitted: Path
    students: tuple[str, ...]
    assignments: tuple[str, ...]


def find_batch(course: Course, submitted: Path, assignment: str | None) -> Batch:
    """Look through a folder of submissions in nbgrader's layout.

    Raises
    ------
    ValueError
        If the folder is not there or empty, or holds nothing for any assignment of the course.
    """
    if not submitted.is_dir():
        raise ValueError(f"{submitted} is not a folder. Expected <student>/<assignment>/<assignment>.ipynb below it.")
    students = sorted(path.name for path in submitted.iterdir() if path.is_dir() and not path.name.startswith("."))
    known = course.assignments()
    if assignment is not None and assignment not in known:
        raise ValueError(f"there is no assignment {assignment!r}; there are {', '.join(known)}.")
    there = [name for name in known if any((submitted / student / name).is_dir() for student in students)]
    wanted = [assignment] if assignment is not None else there
    if not students or not wanted:
        raise ValueError(
            f"{submitted} holds no submission: expected <student>/<assignment>/<assignment>.ipynb below it."
        )
    return Batch(submitted, tuple(students), tuple(wanted))


def grade_batch(course: Course, batch: Batch, out: Path, workshop: Workshop, jobs: int = 1) -> Iterator[Graded]:
    """Grade every student's submission of every assignment; yields each when its result is safe on disk.

    Parameters
    ----------
    course : Course
    batch : Batch
    out : Path
        Gets ``results``, ``autograded``, ``gradebook.db`` and ``grades.csv``.
    workshop : Workshop
        Starts students' processes.
    jobs : int
        Submissions at a time.

    Yields
    ------
    Graded
    """
    templates = {name: read_template(course, name) for name in batch.assignments}
    has_gradebook = gradebook.is_there(out)
    gradebook.prepare(course, out, batch.assignments)
    shared = load_record(course.record) if course.record.is_file() else None
    environment = _environment_fingerprint(course)
    with ThreadPoolExecutor(jobs) as pool:
        waiting: dict[Future[SubmissionResult], str] = {}
        try:
            for name in batch.assignments:
                for student in batch.students:
                    folder = batch.submitted / student / name
                    fingerprint = _fingerprint(environment, folder, templates[name])
                    if has_gradebook and _still_good(out, student, name, fingerprint):
                        yield Graded(student, name, fresh=False)
                        continue
                    task = pool.submit(_grade_one, course, folder, student, templates[name], shared, workshop)
                    waiting[task] = fingerprint
            for task in as_completed(waiting):
                result = task.result()
                template = templates[result.assignment]
                headings = {cell.id: cell.heading for cell in template.questions}
                gradebook.write_autograded(course, out, result)
                gradebook.record(out, [result])
                results.store(out, result, template.title, headings, waiting[task])
                yield Graded(result.student, result.assignment, fresh=True)
        except BaseException as stopped:
            pool.shutdown(wait=False, cancel_futures=True)
            if isinstance(stopped, KeyboardInterrupt):
                workshop.close()  # or code that is still running would be waited for
            raise
    write_grades(out)


def write_grades(out: Path) -> None:
    """Write grades.csv from the results and from what was graded by hand."""
    rows = results.grade_rows(results.load_all(out), gradebook.manual_scores(out))
    results.write_csv(out / "grades.csv", results.GRADE_COLUMNS, rows)


def _grade_one(
    course: Course, folder: Path, student: str, template: Template, record: Record | None, workshop: Workshop
) -> SubmissionResult:
    submission = take_in(folder, student, template)
    assignment = load_assignment(template.assignment)
    assets = Assets(template, assignment, record if assignment.record_file else None, PUBLIC_SECRET)
    with tempfile.TemporaryDirectory(prefix="labsid-", ignore_cleanup_errors=True) as bench:
        if assignment.record_file:
            shutil.copyfile(course.record, Path(bench) / assignment.record_file)
        return judge_submission(submission, assets, workshop, Path(bench))


def _environment_fingerprint(course: Course) -> str:
    """Of what decides a result besides the hand-in and its release: the code, the record and the versions."""
    digest = hashlib.sha256()
    for package in (Path(inspect.getfile(labsid)).parent, Path(__file__).parent):
        for path in sorted(package.rglob("*.py")):
            digest.update(path.relative_to(package).as_posix().encode() + path.read_bytes())
    if course.record.is_file():
        digest.update(course.record.read_bytes())
    digest.update(f"{labsid.__version__} {numpy.__version__} {scipy.__version__}".encode())
    return digest.hexdigest()


def _fingerprint(environment: str, folder: Path, template: Template) -> str:
    digest = hashlib.sha256(environment.encode())
    for path in sorted(path for path in folder.glob("*.ipynb") if path.is_file()):
        with path.open("rb") as file:
            content = hashlib.file_digest(file, "sha256").digest()
        digest.update(os.fsencode(path.name) + b"\0" + content)
    digest.update(template_hash(template).encode())
    return digest.hexdigest()


def _still_good(out: Path, student: str, assignment: str, fingerprint: str) -> bool:
    path = results.result_path(out, student, assignment)
    try:
        return path.is_file() and results.load(path).fingerprint == fingerprint
    except ValueError:
        return False
