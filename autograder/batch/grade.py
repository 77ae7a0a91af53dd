"""Grade a whole class: read the submissions, judge them in parallel, write the results in one thread."""

import contextlib
import hashlib
import hmac
import shlex
import sqlite3
from collections.abc import Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from datetime import datetime
from decimal import Decimal
from pathlib import Path

from autograder.batch.fingerprint import reason_for_regrading, result_fingerprint
from autograder.batch.grading_inputs import DataStore, inputs_for
from autograder.batch.hand_ins import HandIn, judge_hand_in
from autograder.batch.judge_process import JudgePool
from autograder.batch.selection import Batch
from autograder.batch.tasks import Executor
from autograder.course.layout import Course, read_template
from autograder.course.settings import read_settings
from autograder.intake.submission import (
    LATE_FILE,
    MAX_NOTE_CHARACTERS,
    Submission,
    is_plain_file,
    quarantined_submission,
)
from autograder.judge.outcome import SubmissionResult
from autograder.results import gradebook, result_files
from autograder.results.autograded import write_autograded
from autograder.results.extensions import Extensions
from autograder.results.grades import write_grades
from autograder.results.late import ON_TIME, LateRules, late_penalty, read_timestamp
from autograder.results.result_files import StoredResult
from autograder.results.sent_tries import gather_tries
from autograder.sandbox.isolation import is_weaker
from labsid._files import write_text
from labsid.checks.cells import Template


@dataclass(frozen=True, slots=True)
class Graded:
    """A graded submission.

    Attributes
    ----------
    student, assignment : str
    fresh : bool
        False if the result of an earlier run is still valid.
    reason : str
        Why it was graded: ``new``, or what changed since the earlier run, such as ``submission`` or ``check``; empty
        if it is not fresh.
    """

    student: str
    assignment: str
    fresh: bool
    reason: str = ""


def grade_batch(
    course: Course,
    batch: Batch,
    out: Path,
    executor: Executor,
    secret: bytes | None = None,
    late: LateRules | None = None,
    extensions: Extensions | None = None,
) -> Iterator[Graded]:
    """Grade every student's submission of every assignment; yields each one after its result is written.

    Parameters
    ----------
    course : Course
    batch : Batch
    out : Path
        Receives ``results``, ``autograded``, ``gradebook.db``, ``grades.csv``, and ``tries`` if some were sent.
    executor : Executor
        Executes and judges.
    secret : bytes, optional
        The course's secret; each student is graded on the record derived from it and the student's ID.
    late : mapping, optional
        Rules for late submissions; without them there is no penalty.
    extensions : mapping, optional
        Own due dates of single students.

    Yields
    ------
    Graded

    Raises
    ------
    ValueError
        If another run is writing to `out`, if it was graded with another secret, or the course has not been built.
    """
    templates = {name: read_template(course, name) for name in batch.assignments}
    out.mkdir(parents=True, exist_ok=True)
    with _exclusive_writer(out):
        _require_same_secret(batch, out, secret)
        previous = {(result.student, result.assignment): result for result in result_files.load_valid(out)}
        gradebook.prepare(course, out, batch.assignments)
        gradebook.enter(out, previous.values())  # an earlier run may have been killed before it entered them
        data_store = DataStore(course, secret, out / "records", read_settings(course).without_second_record)
        with contextlib.closing(JudgePool()) as judges:
            grader = _BatchGrader(
                course, batch, out, executor, judges, data_store, late or {}, extensions or {}, templates, previous
            )
            yield from grader.run(gradebook.read_manual_grades(out))
        gradebook.enter(out, result_files.load_all(out))
        write_grades(out)
        for name, template in templates.items():
            gather_tries(batch.submitted, batch.students, name, {cell.id for cell in template.questions}, out)


@dataclass(frozen=True, slots=True)
class _NewResult:
    """The result of a submission graded in this run, and the form in which it is stored."""

    result: SubmissionResult
    stored: StoredResult


@dataclass(frozen=True, slots=True)
class _BatchGrader:
    """Grades one batch."""

    course: Course
    batch: Batch
    out: Path
    executor: Executor
    judges: JudgePool
    data_store: DataStore
    late: LateRules
    extensions: Extensions
    templates: Mapping[str, Template]
    previous: Mapping[tuple[str, str], StoredResult]

    def run(self, by_hand: gradebook.ManualGrades) -> Iterator[Graded]:
        """Grade what is missing or has changed; only this thread writes."""
        with ThreadPoolExecutor(self.executor.max_pending) as pool:
            pending: dict[Future[_NewResult | None], tuple[str, str]] = {}
            try:
                for name in self.batch.assignments:
                    for student in self.batch.students:
                        pending[pool.submit(self._grade_if_needed, student, name)] = student, name
                for future in as_completed(pending):
                    student, name = pending.pop(future)
                    yield self._store(student, name, future.result(), by_hand)
            except BaseException as stopped:
                pool.shutdown(wait=False, cancel_futures=True)
                if isinstance(stopped, KeyboardInterrupt):
                    self.judges.close()  # or the pool would wait for them and for running student code
                    self.executor.close()
                raise

    def _store(self, student: str, name: str, new: _NewResult | None, by_hand: gradebook.ManualGrades) -> Graded:
        """Write a result with its late penalty and manual grades to review; without a new one, keep the previous."""
        previous = self.previous.get((student, name))
        if new is None:
            assert previous is not None
            stored = self._with_penalty(previous)
            if stored is not previous:
                result_files.store(self.out, stored)
            return Graded(student, name, fresh=False)
        write_autograded(self.course, self.out, new.result)
        stored = self._with_penalty(new.stored)
        if previous is not None:
            stored = replace(stored, review=_to_review(previous, stored, by_hand))
        result_files.store(self.out, stored)
        return Graded(student, name, True, reason_for_regrading(previous, stored, self.executor.level))

    def _with_penalty(self, stored: StoredResult) -> StoredResult:
        folder = self.batch.submitted / stored.student / stored.assignment
        submitted, told_late = _submission_time(folder), is_plain_file(folder / LATE_FILE, MAX_NOTE_CHARACTERS)
        marks = sum((question.max_score for question in stored.questions), Decimal(0))
        own = self.extensions.get((stored.student, stored.assignment))
        due, text = (None, "") if own is None else (own.due, own.text)
        late = (
            ON_TIME
            if stored.is_refused
            else late_penalty(self.late, stored.assignment, submitted, marks, due, told_late)
        )
        when = None if submitted is None else submitted.isoformat()
        new = replace(stored, submitted=when, penalty=late.penalty, late=late.reason, extension=text)
        return stored if new == stored else new

    def _grade_if_needed(self, student: str, name: str) -> _NewResult | None:
        """Grade a submission; None if the previous result is still valid. Runs in a thread and writes no result."""
        template, folder = self.templates[name], self.batch.submitted / student / name
        refused: Submission | None = None
        try:
            inputs = inputs_for(self.data_store, template, student)
        except ValueError as error:
            inputs = inputs_for(replace(self.data_store, secret=None), template, student)
            refused = quarantined_submission(student, name, f"no record can be generated for this student: {error}")
        fingerprint = result_fingerprint(self.data_store, inputs, folder)
        previous = self.previous.get((student, name))
        if (
            previous is not None
            and previous.fingerprint == fingerprint
            and not is_weaker(previous.isolation, self.executor.level)
        ):
            return None
        hand_in = HandIn(student, template, folder, inputs, refused)
        judged = judge_hand_in(hand_in, self.executor, self.judges, self.data_store, self.batch.students)
        headings = {cell.id: cell.heading for cell in template.questions}
        stored = result_files.to_stored(judged.result, template.title, headings, fingerprint)
        if judged.try_again:
            stored = replace(stored, fingerprint={**fingerprint, "environment": ""})
        return _NewResult(judged.result, replace(stored, work=judged.work, copied=judged.copied))


def _to_review(previous: StoredResult, new: StoredResult, by_hand: gradebook.ManualGrades) -> tuple[str, ...]:
    """Manually graded questions that need a review, because answers or automatic scores have changed."""
    old = {question.question: question for question in previous.questions}
    changed = {
        one.question
        for one in new.questions
        if one.question not in old
        or (one.score, one.answer.strip()) != (old[one.question].score, old[one.question].answer.strip())
    }
    owner = new.student, new.assignment
    scored = {question for student, assignment, question in by_hand.scores if (student, assignment) == owner}
    return tuple(sorted(scored)) if changed else ()


def _submission_time(folder: Path) -> datetime | None:
    """The submission time in nbgrader's ``timestamp.txt``."""
    path = folder / "timestamp.txt"
    try:
        if not path.is_file():  # opening a pipe would block
            return None
        with path.open(encoding="utf-8", errors="replace") as file:
            return read_timestamp(file.read(200))
    except OSError:
        return None


def _require_same_secret(batch: Batch, out: Path, secret: bytes | None) -> None:
    """Refuse to grade OUT, which was graded with a secret, without it or with another one; remember a first secret."""
    marker = out / ".secret"
    digest = "" if secret is None else hmac.new(secret, b"labsid: graded with", hashlib.sha256).hexdigest()
    if not marker.is_file() and secret is None and not (out / "records").is_dir():
        return
    if secret is None or (marker.is_file() and marker.read_text(encoding="ascii") != digest):
        given = "without --secret" if secret is None else "with another secret"
        again = shlex.join(["labsid", "course", "grade", "--submitted", str(batch.submitted), "--out", str(out)])
        raise ValueError(
            f"{out} was graded with --secret; {given}, everybody would be graded on another record. "
            f"Run: {again} --secret FILE"
        )
    write_text(marker, digest)


@contextlib.contextmanager
def _exclusive_writer(out: Path) -> Iterator[None]:
    """Lock OUT for this run; the operating system releases the lock however the run ends."""
    with contextlib.ExitStack() as stack:
        try:
            lock = sqlite3.connect(out / ".writer", timeout=0, isolation_level=None)
            stack.callback(lock.close)
            lock.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError as error:
            if "locked" not in str(error):
                raise ValueError(f"{out} cannot be written ({error}). Give --out another folder.") from None
            raise ValueError(f"another 'labsid course grade' is writing to {out}; wait until it is done.") from None
        yield
