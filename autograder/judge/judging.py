"""Judge one submission: run its cells, read its variables and compare them with labsid in this process.

The student's process runs the cells. Only this process holds the checks, the reference and the hidden inputs on which
functions are tested. After a wrong answer its reference values replace the student's, so that later steps are judged on
right inputs.
"""

import builtins
import contextlib
import hashlib
import hmac
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal
from pathlib import Path

import numpy as np

from autograder.course.layout import Template
from autograder.intake.submission import NotebookCell, Submission
from autograder.judge.ask import CallDeferred, ProcessAsk, error_text
from autograder.judge.execution import ExecutedCell, Execution
from autograder.judge.outcome import QuestionResult, SubmissionResult, ungraded_result
from autograder.judge.picture import figure_svg
from autograder.sandbox.isolation import MachineError, ProcessLauncher, Reply, StudentProcess, StudentProcessError
from labsid.checks.question import Assignment, Origin, Question, given_values
from labsid.checks.values import Value
from labsid.checks.verdict import Verdict
from labsid.records.record import Record


@dataclass(frozen=True, slots=True)
class Assets:
    """What judging needs besides the submission.

    Attributes
    ----------
    template : Template
        The released assignment with its points.
    assignment : Assignment
        Its checks.
    record : Record or None
        The student's record.
    secret : bytes
        Seeds the hidden inputs on which functions are tested.
    origin : Origin or None
        Origin of the record, for checks that need what is withheld about it.
    """

    template: Template
    assignment: Assignment
    record: Record | None
    secret: bytes = field(repr=False)
    origin: Origin | None = None


def judge_submission(
    submission: Submission, assets: Assets, launcher: ProcessLauncher, folder: Path, pictures: bool = True
) -> SubmissionResult:
    """Judge a submission.

    Parameters
    ----------
    submission : Submission
    assets : Assets
    launcher : ProcessLauncher
        Starts the student's processes.
    folder : Path
        Work folder of these processes; it contains the record.
    pictures : bool
        Whether to draw the figures that are judged, for the feedback.

    Returns
    -------
    SubmissionResult
        One result for every question of the assignment, whatever the submission does.
    """
    if submission.status != "ready":
        return ungraded_result(submission, assets.template, launcher.level)
    judge = _SubmissionJudge(submission, assets, launcher, folder, pictures)
    results, cells = judge.run()
    return SubmissionResult(
        submission.student, submission.assignment, results, cells, submission.notes, launcher.level, judge.wrong_values
    )


@dataclass(frozen=True, slots=True)
class _DeferredQuestion:
    """A question whose check calls functions and that no later step needs: judged after the last cell."""

    index: int
    question: Question
    points: Decimal
    cells: list[ExecutedCell]
    known: Mapping[str, Value]
    pictures: tuple[str, ...]


_EXECUTED_KINDS = ("given", "answer", "extra")
OUTPUT_REDACTED = "(Output not shown: this cell ran on the right values of an earlier step that was wrong.)\n"


class _SubmissionJudge:
    """Judges one submission, cell by cell."""

    def __init__(
        self, submission: Submission, assets: Assets, launcher: ProcessLauncher, folder: Path, pictures: bool
    ) -> None:
        self._submission = submission
        self._assets = assets
        self._limits = launcher.limits
        self._pictures = pictures
        self._known: dict[str, Value] = {}
        self._deferred: list[_DeferredQuestion] = []
        self._results: list[QuestionResult] = []
        self._failed: list[str] = []
        self._source = "\n".join(cell.source for cell in submission.cells)
        self._has_reference_values = False  # in the student's process
        self.wrong_values: dict[str, dict[str, Value]] = {}
        self._execution = Execution(launcher, folder)

    def run(self) -> tuple[tuple[QuestionResult, ...], tuple[ExecutedCell, ...]]:
        """Run and judge all cells; returns a result for each question, and every cell with its output."""
        points = {cell.id: cell.points or Decimal(0) for cell in self._assets.template.questions}
        executed: list[ExecutedCell] = []
        answer: list[ExecutedCell] = []
        start = time.monotonic()
        try:
            for cell in self._submission.cells:
                runs = cell.code and cell.kind in _EXECUTED_KINDS
                done = self._execution.run(cell) if runs else ExecutedCell(cell, Reply(True))
                done = redact_output(done) if self._has_reference_values else done
                executed.append(done)
                if cell.kind in ("answer", "extra") and cell.code:
                    answer.append(done)
                if cell.kind not in ("question", "manual"):
                    continue
                worth = points[cell.id or ""]
                result = self._manual(cell, worth) if cell.kind == "manual" else self._question(cell, worth, answer)
                now = time.monotonic()
                self._results.append(replace(result, seconds=now - start))
                start, answer = now, []
            self._judge_deferred()
        finally:
            self._execution.close()
        return tuple(self._results), tuple(executed)

    def _manual(self, cell: NotebookCell, points: Decimal) -> QuestionResult:
        released = next(known.source for known in self._assets.template.cells if known.id == cell.id)
        empty = cell.source.strip() in ("", released.strip())
        reason = "no answer" if empty else "not yet graded by hand"
        return QuestionResult(cell.id or "", None, points, "manual", reason, answer=cell.source)

    def _question(self, cell: NotebookCell, points: Decimal, answer: list[ExecutedCell]) -> QuestionResult:
        question = self._assets.assignment.question(cell.id or "")
        ask = self._ask(question, lambda: self._execution.process, self._known)
        first_ask = ask  # its figures were drawn before any function received a hidden input
        verdict, failure = None, next((done.failure for done in answer if done.failure is not None), None)
        if failure is None:
            try:
                ask.defer_calls = True
                verdict, failure = self._verdict(question, ask)
            except CallDeferred:
                if question.gives is None:
                    return self._defer(question, points, answer, first_ask)
                ask = self._ask(question, lambda: self._execution.process, self._known)
                try:
                    with self._execution.call_process() as ask.call_process:
                        verdict, failure = self._verdict(question, ask)
                except StudentProcessError as error:
                    failure = error
                ask.call_process = None
        result = self._result(question, points, answer, verdict, failure, self._drawn(first_ask))
        self._carry_forward(question, ask, passed=bool(verdict and verdict.passed))
        return result

    def _defer(
        self, question: Question, points: Decimal, answer: list[ExecutedCell], ask: ProcessAsk
    ) -> QuestionResult:
        """Save the variables for judging the question later; returns a placeholder."""
        index = len(self._results)
        self._execution.save_variables(index)
        self._deferred.append(_DeferredQuestion(index, question, points, answer, dict(self._known), self._drawn(ask)))
        return QuestionResult(question.id, None, points, "waiting", "")

    def _judge_deferred(self) -> None:
        """Call functions on hidden inputs, now that no later output can reveal them."""
        if self._deferred and self._execution.process.lost:  # the cells have used up the time of the submission
            self._execution.extend_deadline(self._limits.cell_seconds)
            self._execution.restart()
        for deferred in self._deferred:
            start = time.monotonic()
            self._execution.extend_deadline(self._limits.call_seconds)
            ask = self._ask(deferred.question, lambda: self._execution.process, deferred.known)
            verdict, failure, changed = None, None, False
            try:
                changed = self._execution.process.restore_variables(deferred.index)
            except StudentProcessError as error:
                failure = error
                self._execution.restart()
            if failure is None:
                verdict, failure = self._verdict(deferred.question, ask)
            if changed and verdict is not None and not verdict.passed:
                verdict = self._verdict_after_replay(deferred) or verdict
            result = self._result(
                deferred.question, deferred.points, deferred.cells, verdict, failure, deferred.pictures
            )
            if result.score == 0:
                self._failed.append(deferred.question.id)
            before = self._results[deferred.index].seconds
            self._results[deferred.index] = replace(result, seconds=before + time.monotonic() - start)

    def _verdict_after_replay(self, deferred: _DeferredQuestion) -> Verdict | None:
        """Judge in a process without the later cells, which have modified variables in place; None if that fails."""
        try:
            with contextlib.closing(self._execution.replayed(deferred.index)) as process:
                return deferred.question.verdict(self._ask(deferred.question, lambda: process, deferred.known))
        except MachineError:
            raise
        except Exception:  # the process ended, or the check is broken: the first verdict stands
            return None

    def _drawn(self, ask: ProcessAsk) -> tuple[str, ...]:
        return tuple(map(figure_svg, ask.figures)) if self._pictures and not self._has_reference_values else ()

    def _verdict(self, question: Question, ask: ProcessAsk) -> tuple[Verdict | None, StudentProcessError | None]:
        try:
            return question.verdict(ask), None
        except StudentProcessError as failure:
            if self._execution.process.lost:
                self._execution.restart()
            return None, failure
        except Exception as error:  # a broken check must not affect the other questions
            text = f"This answer could not be judged ({type(error).__name__}). Tell your instructor."
            return Verdict(False, text), None

    def _result(
        self,
        question: Question,
        points: Decimal,
        answer: list[ExecutedCell],
        verdict: Verdict | None,
        failure: StudentProcessError | None,
        pictures: tuple[str, ...],
    ) -> QuestionResult:
        status = "graded"
        if verdict is None or failure is not None:
            status = "crashed" if failure is None else failure.status
            verdict = Verdict(False, f"Your code for this step did not finish: {failure}.")
        elif not verdict.passed:
            verdict = _with_cell_error(verdict, answer)
            if any((done.reply.error or {}).get("kind") == "MemoryError" for done in answer):
                status = "limit"
        if verdict.passed and (failed := [used for used in question.uses if used in self._failed]):
            verdict = replace(verdict, reason=f"{verdict.reason} (Judged on the right values of {', '.join(failed)}.)")
        return QuestionResult(
            question.id,
            points if verdict.passed else Decimal(0),
            points,
            status,
            verdict.reason,
            verdict.slip,
            answer="\n\n".join(done.cell.source for done in answer),
            output="".join(done.reply.stdout for done in answer),
            figures=pictures,
        )

    def _carry_forward(self, question: Question, ask: ProcessAsk, passed: bool) -> None:
        """Keep the values from which later steps start: the student's, or after a wrong answer the reference's."""
        if not passed:
            self._failed.append(question.id)
        ask.defer_calls = False
        try:
            values = given_values(question, ask, passed)
        except StudentProcessError:
            self._execution.restart()
            values = given_values(question, ask, passed=False)
        except Exception:  # the questions that need these values will report that they could not be judged
            return
        self._known.update(values)
        if values and not passed:
            self.wrong_values[question.id] = ask.values_read(values)
            self._execution.set(values)
            self._has_reference_values = True

    def _ask(self, question: Question, process: Callable[[], StudentProcess], known: Mapping[str, Value]) -> ProcessAsk:
        identity = f"{self._submission.student}\0{self._submission.assignment}\0{question.id}".encode(
            errors="surrogatepass"
        )
        seed = hmac.new(self._assets.secret, identity, hashlib.sha256).digest()
        rng = np.random.default_rng(list(seed))
        return ProcessAsk(process, self._assets.record, known, rng, self._assets.origin, self._source)


def redact_output(executed: ExecutedCell) -> ExecutedCell:
    """Remove all output of a cell that could reveal the reference values on which it ran."""
    cell, reply, error = executed.cell, executed.reply, executed.reply.error
    if cell.kind == "extra" and cell.code:  # students can add any number of these: even whether one fails reveals a bit
        return replace(executed, reply=Reply(True, None, None, OUTPUT_REDACTED))
    if error is not None:
        kind, line = str(error.get("kind")), error.get("line")
        shown = {"kind": kind if hasattr(builtins, kind) else "an error", "text": ""}
        error = {**shown, "line": line} if line in range(1, cell.source.count("\n") + 2) else shown
    return replace(executed, reply=Reply(reply.ok, None, error, OUTPUT_REDACTED if reply.stdout else ""))


def _with_cell_error(verdict: Verdict, answer: list[ExecutedCell]) -> Verdict:
    """Put the error that stopped the cell, if any, before the reason: the student has to correct it first."""
    for done in answer:
        error = done.reply.error
        if error is not None:
            line = f" in line {error['line']}" if error.get("line") else ""
            return replace(verdict, reason=f"Your cell stopped{line} with {error_text(error)}. {verdict.reason}")
    return verdict
