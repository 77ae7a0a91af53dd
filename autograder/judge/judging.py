"""Judging one submission: walk through its cells, ask for values, compare with labsid in this process.

The student's process runs the cells; this one alone holds the checks, the reference and the inputs on which
functions are tried. A question that fails has its right values put in the place of the student's, so that later
steps are judged on them.
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
from autograder.sandbox.isolation import ProcessLauncher, Reply, StudentProcess, StudentProcessError
from labsid.checks.question import Assignment, Origin, Question, given_values
from labsid.checks.values import Value
from labsid.checks.verdict import Verdict
from labsid.records.record import Record


@dataclass(frozen=True, slots=True)
class Assets:
    """What judging a submission takes besides the submission.

    Attributes
    ----------
    template : Template
        The released assignment with its points.
    assignment : Assignment
        Its checks.
    record : Record or None
        The record that this student works on.
    secret : bytes
        Seeds the inputs on which functions are tried.
    origin : Origin or None
        Where the record comes from, for checks that know what is withheld about it.
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
        As the intake made it.
    assets : Assets
    launcher : ProcessLauncher
        Starts the student's process.
    folder : Path
        The work folder of that process; the record lies in it.
    pictures : bool
        Whether to keep pictures of the figures that are judged, for the feedback.

    Returns
    -------
    SubmissionResult
        One result for every question of the assignment, whatever the submission does.
    """
    if submission.status != "ready":
        return ungraded_result(submission, assets.template, launcher.level)
    walk = _SubmissionJudge(submission, assets, launcher, folder, pictures)
    results, ran = walk.results()
    return SubmissionResult(
        submission.student, submission.assignment, results, ran, submission.notes, launcher.level, walk.wrong
    )


@dataclass(frozen=True, slots=True)
class _DeferredQuestion:
    """A question that wants functions called: judged when nothing that the student sees comes after."""

    place: int
    question: Question
    points: Decimal
    ran: list[ExecutedCell]
    known: Mapping[str, Value]
    pictures: tuple[str, ...]


_EXECUTED_KINDS = ("given", "answer", "extra")
OUTPUT_REDACTED = (
    "(What this cell printed is left out: it ran on the right values of an earlier step that went wrong.)\n"
)


class _SubmissionJudge:
    """One walk through a submission, with what has been learnt on the way."""

    def __init__(
        self, submission: Submission, assets: Assets, launcher: ProcessLauncher, folder: Path, pictures: bool
    ) -> None:
        self._submission = submission
        self._assets = assets
        self._limits = launcher.limits
        self._pictures = pictures
        self._known: dict[str, Value] = {}
        self._waiting: list[_DeferredQuestion] = []
        self._found: list[QuestionResult] = []
        self._failed: list[str] = []
        self._source = "\n".join(step.source for step in submission.steps)
        self._told = False  # whether right values stand in the student's process
        self.wrong: dict[str, dict[str, Value]] = {}
        self._running = Execution(launcher, folder)

    def results(self) -> tuple[tuple[QuestionResult, ...], tuple[ExecutedCell, ...]]:
        """Go through every cell; one result a question, and every cell with what came of it."""
        points = {cell.id: cell.points or Decimal(0) for cell in self._assets.template.questions}
        gone: list[ExecutedCell] = []
        answer: list[ExecutedCell] = []
        start = time.monotonic()
        try:
            for step in self._submission.steps:
                ran = (
                    self._running.run(step)
                    if step.code and step.kind in _EXECUTED_KINDS
                    else ExecutedCell(step, Reply(True))
                )
                ran = redact_output(ran) if self._told else ran
                gone.append(ran)
                if step.kind in ("answer", "extra") and step.code:
                    answer.append(ran)
                if step.kind not in ("question", "manual"):
                    continue
                worth = points[step.id or ""]
                result = self._manual(step, worth) if step.kind == "manual" else self._question(step, worth, answer)
                now = time.monotonic()
                self._found.append(replace(result, seconds=now - start))
                start, answer = now, []
            self._judge_waiting()
        finally:
            self._running.close()
        return tuple(self._found), tuple(gone)

    def _manual(self, step: NotebookCell, points: Decimal) -> QuestionResult:
        released = next(cell.source for cell in self._assets.template.cells if cell.id == step.id)
        empty = step.source.strip() in ("", released.strip())
        reason = "no answer" if empty else "waits to be graded by hand"
        return QuestionResult(step.id or "", None, points, "manual", reason, answer=step.source)

    def _question(self, step: NotebookCell, points: Decimal, ran: list[ExecutedCell]) -> QuestionResult:
        question = self._assets.assignment.question(step.id or "")
        ask = self._ask(question, lambda: self._running.student, self._known)
        first = ask  # its pictures show what was drawn before any function saw a hidden input
        verdict, death = None, next((cell.death for cell in ran if cell.death is not None), None)
        if death is None:
            try:
                ask.later = True
                verdict, death = self._verdict(question, ask)
            except CallDeferred:
                if question.gives is None:
                    place = len(self._found)
                    self._running.pin(place)
                    waiting = _DeferredQuestion(place, question, points, ran, dict(self._known), self._drawn(first))
                    self._waiting.append(waiting)
                    return QuestionResult(question.id, None, points, "waiting", "")
                ask = self._ask(question, lambda: self._running.student, self._known)
                try:
                    with self._running.apart() as ask.calls:
                        verdict, death = self._verdict(question, ask)
                except StudentProcessError as died:
                    death = died
                ask.calls = None
        result = self._result(question, points, ran, verdict, death, self._drawn(first))
        self._carry_forward(question, ask, passed=bool(verdict and verdict.passed))
        return result

    def _judge_waiting(self) -> None:
        """Call functions on the hidden inputs, when no output comes any more that could tell of them."""
        if self._waiting and self._running.student.lost:  # the time for everything was used up by what came after
            self._running.more_time(self._limits.cell_seconds)
            self._running.revive()
        for one in self._waiting:
            start = time.monotonic()
            self._running.more_time(self._limits.call_seconds)
            ask = self._ask(one.question, lambda: self._running.student, one.known)
            verdict, death, changed = None, None, False
            try:
                changed = self._running.student.restore_variables(one.place)
            except StudentProcessError as died:
                death = died
                self._running.revive()
            if death is None:
                verdict, death = self._verdict(one.question, ask)
            if changed and verdict is not None and not verdict.passed:
                verdict = self._exact_verdict(one) or verdict
            result = self._result(one.question, one.points, one.ran, verdict, death, one.pictures)
            if result.score == 0:
                self._failed.append(one.question.id)
            before = self._found[one.place].seconds
            self._found[one.place] = replace(result, seconds=before + time.monotonic() - start)

    def _exact_verdict(self, one: _DeferredQuestion) -> Verdict | None:
        """Judge in a process that never went further than the question: later cells changed things in place."""
        try:
            with contextlib.closing(self._running.replayed(one.place)) as student:
                return one.question.verdict(self._ask(one.question, lambda: student, one.known))
        except Exception:  # the process died, or the check broke: then what was found before stands
            return None

    def _drawn(self, ask: ProcessAsk) -> tuple[str, ...]:
        return tuple(map(figure_svg, ask.figures)) if self._pictures and not self._told else ()

    def _verdict(self, question: Question, ask: ProcessAsk) -> tuple[Verdict | None, StudentProcessError | None]:
        try:
            return question.verdict(ask), None
        except StudentProcessError as died:
            if self._running.student.lost:
                self._running.revive()
            return None, died
        except Exception as error:  # a check must never take the other questions with it
            said_so = f"This answer could not be judged ({type(error).__name__}). Tell your teacher."
            return Verdict(False, said_so), None

    def _result(
        self,
        question: Question,
        points: Decimal,
        ran: list[ExecutedCell],
        verdict: Verdict | None,
        death: StudentProcessError | None,
        pictures: tuple[str, ...],
    ) -> QuestionResult:
        status = "graded"
        if verdict is None or death is not None:
            status = "crashed" if death is None else death.status
            verdict = Verdict(False, f"Your code for this step did not come back: {death}.")
        elif not verdict.passed:
            verdict = _with_cell_error(verdict, ran)
            if any((cell.reply.error or {}).get("kind") == "MemoryError" for cell in ran):
                status = "limit"
        if verdict.passed and (spoilt := [used for used in question.uses if used in self._failed]):
            verdict = replace(verdict, reason=f"{verdict.reason} (Judged on the right values of {', '.join(spoilt)}.)")
        return QuestionResult(
            question.id,
            points if verdict.passed else Decimal(0),
            points,
            status,
            verdict.reason,
            verdict.slip,
            answer="\n\n".join(cell.step.source for cell in ran),
            output="".join(cell.reply.stdout for cell in ran),
            figures=pictures,
        )

    def _carry_forward(self, question: Question, ask: ProcessAsk, passed: bool) -> None:
        if not passed:
            self._failed.append(question.id)
        ask.later = False
        try:
            given = given_values(question, ask, passed)
        except StudentProcessError:
            self._running.revive()
            given = given_values(question, ask, passed=False)
        except Exception:  # the questions that start from these values will say that they could not be judged
            return
        self._known.update(given)
        if given and not passed:
            self.wrong[question.id] = ask.values_of(given)
            self._running.set(given)
            self._told = True

    def _ask(self, question: Question, student: Callable[[], StudentProcess], known: Mapping[str, Value]) -> ProcessAsk:
        identity = f"{self._submission.student}\0{self._submission.assignment}\0{question.id}".encode(
            errors="surrogatepass"
        )
        seed = hmac.new(self._assets.secret, identity, hashlib.sha256).digest()
        rng = np.random.default_rng(list(seed))
        return ProcessAsk(student, self._assets.record, known, rng, self._assets.origin, self._source)


def redact_output(ran: ExecutedCell) -> ExecutedCell:
    """What a cell said, without anything that could tell the right values that it was run with."""
    reply, error = ran.reply, ran.reply.error
    if ran.step.kind == "extra" and ran.step.code:  # of any number of these, even whether they stop would tell
        return replace(ran, reply=Reply(True, None, None, OUTPUT_REDACTED))
    if error is not None:
        kind, line = str(error.get("kind")), error.get("line")
        told = {"kind": kind if hasattr(builtins, kind) else "an error", "text": ""}
        error = {**told, "line": line} if line in range(1, ran.step.source.count("\n") + 2) else told
    return replace(ran, reply=Reply(reply.ok, None, error, OUTPUT_REDACTED if reply.stdout else ""))


def _with_cell_error(verdict: Verdict, ran: list[ExecutedCell]) -> Verdict:
    """Say first that the cell above stopped, where it did: that is what the student must mend."""
    for cell in ran:
        error = cell.reply.error
        if error is not None:
            line = f" in line {error['line']}" if error.get("line") else ""
            return replace(verdict, reason=f"Your cell stopped{line} with {error_text(error)}. {verdict.reason}")
    return verdict
