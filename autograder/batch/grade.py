"""Grading a whole class: intake, judging in parallel, one writer."""

import contextlib
import sqlite3
from collections.abc import Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from datetime import datetime
from decimal import Decimal
from pathlib import Path

from autograder.batch.assets import DataStore, GradingInputs, inputs_for
from autograder.batch.executors import Executor, Task
from autograder.batch.fingerprint import fingerprint, what_changed
from autograder.batch.wrong_record import marked
from autograder.course.layout import Course, Template, read_template
from autograder.intake.submission import Submission, quarantined, take_in
from autograder.judge.outcome import SubmissionResult, not_judged
from autograder.results import gradebook, result_files
from autograder.results.autograded import write_autograded
from autograder.results.late import ON_TIME, LateRules, late_for, read_timestamp
from autograder.results.result_files import StoredResult
from autograder.results.similar import work_of
from autograder.sandbox.isolation import is_weaker


@dataclass(frozen=True, slots=True)
class Graded:
    """One submission that is done.

    Attributes
    ----------
    student, assignment : str
    fresh : bool
        False where the result of an earlier run was still good.
    why : str
        Of a fresh one: ``new``, or what has changed since the earlier run, such as ``submission`` or ``check``.
    """

    student: str
    assignment: str
    fresh: bool
    why: str = ""


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


def grade_batch(
    course: Course,
    batch: Batch,
    out: Path,
    executor: Executor,
    secret: bytes | None = None,
    late: LateRules | None = None,
) -> Iterator[Graded]:
    """Grade every student's submission of every assignment; yields each when its result is safe on disk.

    Parameters
    ----------
    course : Course
    batch : Batch
    out : Path
        Gets ``results``, ``autograded``, ``gradebook.db`` and ``grades.csv``.
    executor : Executor
        Executes and judges.
    secret : bytes, optional
        The course's secret: every student is graded on the record derived from it and their ID.
    late : mapping, optional
        Rules for late hand-ins; without them nothing is taken off.

    Yields
    ------
    Graded

    Raises
    ------
    ValueError
        If another run is writing to `out`, or the course has not been built.
    """
    templates = {name: read_template(course, name) for name in batch.assignments}
    out.mkdir(parents=True, exist_ok=True)
    with _only_writer(out):
        before = {(one.student, one.assignment): one for one in result_files.load_good(out)}
        gradebook.prepare(course, out, batch.assignments)
        gradebook.enter(out, before.values())  # what a run that was killed had not entered
        data_store = DataStore(course, secret, out / "records")
        office = _Office(course, batch, out, executor, data_store, late or {}, templates, before)
        yield from office.run(gradebook.given_by_hand(out))
        gradebook.enter(out, result_files.load_all(out))
        write_grades(out)


@dataclass(frozen=True, slots=True)
class _Fresh:
    """What came of a submission that was graded just now, and how it is kept."""

    result: SubmissionResult
    stored: StoredResult


@dataclass(frozen=True, slots=True)
class _Office:
    """What grading a batch takes."""

    course: Course
    batch: Batch
    out: Path
    executor: Executor
    data_store: DataStore
    late: LateRules
    templates: Mapping[str, Template]
    before: Mapping[tuple[str, str], StoredResult]

    def run(self, by_hand: gradebook.ByHand) -> Iterator[Graded]:
        """Grade what is missing or has changed; this thread alone writes."""
        with ThreadPoolExecutor(self.executor.at_once) as pool:
            waiting: dict[Future[_Fresh | None], tuple[str, str]] = {}
            try:
                for name in self.batch.assignments:
                    for student in self.batch.students:
                        waiting[pool.submit(self._look_at, student, name)] = student, name
                for task in as_completed(waiting):
                    student, name = waiting.pop(task)
                    yield self._keep(student, name, task.result(), by_hand)
            except BaseException as stopped:
                pool.shutdown(wait=False, cancel_futures=True)
                if isinstance(stopped, KeyboardInterrupt):
                    self.executor.close()  # or code that is still running would be waited for
                raise

    def _keep(self, student: str, name: str, fresh: "_Fresh | None", by_hand: gradebook.ByHand) -> Graded:
        """Write a result, with what it cost to be late and which hand grading has to be looked at again."""
        known = self.before.get((student, name))
        if fresh is None:
            assert known is not None
            kept = self._with_lateness(known)
            if kept is not known:
                result_files.store(self.out, kept)
            return Graded(student, name, fresh=False)
        write_autograded(self.course, self.out, fresh.result)
        kept = self._with_lateness(fresh.stored)
        if known is not None:
            kept = replace(kept, review=_to_review(known, kept, by_hand))
        result_files.store(self.out, kept)
        return Graded(student, name, True, what_changed(known, kept, self.executor.level))

    def _with_lateness(self, stored: StoredResult) -> StoredResult:
        submitted = _handed_in(self.batch.submitted / stored.student / stored.assignment)
        marks = sum((question.max_score for question in stored.questions), Decimal(0))
        late = ON_TIME if stored.is_refused else late_for(self.late, stored.assignment, submitted, marks)
        when = None if submitted is None else submitted.isoformat()
        if (stored.submitted, stored.penalty, stored.late) == (when, late.penalty, late.reason):
            return stored
        return replace(stored, submitted=when, penalty=late.penalty, late=late.reason)

    def _look_at(self, student: str, name: str) -> "_Fresh | None":
        """Grade a submission; None where the earlier result is still good. Runs beside others and writes no result."""
        template, folder = self.templates[name], self.batch.submitted / student / name
        refused: Submission | None = None
        try:
            inputs = inputs_for(self.data_store, template, student)
        except ValueError as error:
            inputs = inputs_for(replace(self.data_store, secret=None), template, student)
            refused = quarantined(student, name, f"no record can be made for this student: {error}")
        parts = fingerprint(self.data_store, inputs, folder)
        known = self.before.get((student, name))
        if known is not None and known.fingerprint == parts and not is_weaker(known.isolation, self.executor.level):
            return None
        submission = refused or take_in(folder, student, template)
        result = self._judge(submission, inputs, folder)
        headings = {cell.id: cell.heading for cell in template.questions}
        released = {cell.id: cell.source for cell in template.cells}
        stored = result_files.as_stored(result, template.title, headings, parts)
        if stored.is_refused and submission.status == "ready":  # by the machines, not by us: the next run tries again
            stored = replace(stored, fingerprint={**parts, "environment": ""})
        return _Fresh(result, replace(stored, work=work_of(submission.steps, released)))

    def _judge(self, submission: Submission, inputs: GradingInputs, folder: Path) -> SubmissionResult:
        if submission.status == "ready":
            files = {name: path.read_bytes() for name, path in inputs.files.items()}
            result = self.executor.judge(Task(submission, inputs.assets, files))
        else:
            result = not_judged(submission, inputs.assets.template, self.executor.level)
        return marked(result, inputs, self.data_store, folder, self.batch.students)


def write_grades(out: Path) -> None:
    """Write grades.csv from the results and from what was graded by hand."""
    rows = result_files.grade_rows(result_files.load_all(out), gradebook.given_by_hand(out).scores)
    result_files.write_csv(out / "grades.csv", result_files.GRADE_COLUMNS, rows)


def _to_review(known: StoredResult, new: StoredResult, by_hand: gradebook.ByHand) -> tuple[str, ...]:
    """Questions scored by hand that the teacher has to look at again: the automatic part is another one now."""
    old = {question.question: question for question in known.questions}
    changed = {
        one.question
        for one in new.questions
        if one.question not in old
        or (one.score, one.answer.strip()) != (old[one.question].score, old[one.question].answer.strip())
    }
    mine = new.student, new.assignment
    scored = {question for *owner, question in by_hand.scores if tuple(owner) == mine}
    return tuple(sorted(scored)) if changed else ()


def _handed_in(folder: Path) -> datetime | None:
    """When a submission was handed in, as nbgrader's ``timestamp.txt`` in its folder says."""
    path = folder / "timestamp.txt"
    try:
        if not path.is_file():  # a pipe would be waited for
            return None
        with path.open(encoding="utf-8", errors="replace") as file:
            return read_timestamp(file.read(200))
    except OSError:
        return None


@contextlib.contextmanager
def _only_writer(out: Path) -> Iterator[None]:
    """Hold OUT for this run; the system lets go of it however the run ends."""
    with contextlib.closing(sqlite3.connect(out / ".writer", timeout=0, isolation_level=None)) as lock:
        try:
            lock.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError:
            raise ValueError(f"another 'labsid course grade' is writing to {out}; wait until it is done.") from None
        yield
