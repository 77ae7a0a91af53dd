"""Judging one submission: walk through its cells, ask for values, compare with labsid in this process.

The student's process runs the cells; this one alone holds the checks, the reference and the inputs on which
functions are tried. A question that fails has its right values put in the place of the student's, so that later
steps are judged on them.
"""

import hashlib
import hmac
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path

import numpy as np

from autograder.ask import ProcessAsk, said
from autograder.course import Template
from autograder.intake import Step, Submission
from autograder.isolation import Reply, StudentDied, Workshop
from labsid.checks.question import Assignment, Question, given_values
from labsid.checks.values import Value
from labsid.checks.verdict import Verdict
from labsid.record import Record


@dataclass(frozen=True, slots=True)
class QuestionResult:
    """One line of the grades.

    Attributes
    ----------
    question : str
        The grade_id.
    score : Decimal or None
        None until a manual question is graded by hand.
    max_score : Decimal
    status : str
        One of ``graded, manual, crashed, timeout, limit, missing, quarantined``.
    reason : str
        What the student is told.
    slip : str or None
        Name of the known slip.
    answer : str
        The student's own text or code for this question.
    output : str
        What the answer's cell printed.
    figures : tuple of str
        PNG pictures that it drew, in base64.
    seconds : float
        Time that its cells and the judging took.
    """

    question: str
    score: Decimal | None
    max_score: Decimal
    status: str
    reason: str
    slip: str | None = None
    answer: str = ""
    output: str = ""
    figures: tuple[str, ...] = ()
    seconds: float = 0.0


@dataclass(frozen=True, slots=True)
class SubmissionResult:
    """Everything known of a graded submission.

    Attributes
    ----------
    student, assignment : str
    results : tuple of QuestionResult
        One for every question, in the order of the notebook.
    ran : tuple of Ran
        Every cell that was gone through, with what it printed and drew.
    notes : tuple of str
        What the intake mended, or why it was refused.
    isolation : str
        The rung on which it ran.
    """

    student: str
    assignment: str
    results: tuple[QuestionResult, ...]
    ran: tuple["Ran", ...]
    notes: tuple[str, ...]
    isolation: str


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
    """

    template: Template
    assignment: Assignment
    record: Record | None
    secret: bytes


def judge_submission(
    submission: Submission, assets: Assets, workshop: Workshop, folder: Path, pictures: bool = True
) -> SubmissionResult:
    """Judge a submission.

    Parameters
    ----------
    submission : Submission
        As the intake made it.
    assets : Assets
    workshop : Workshop
        Starts the student's process.
    folder : Path
        The work folder of that process; the record lies in it.
    pictures : bool
        Whether to keep pictures of what the student drew, for the feedback; judging a figure does not need them.

    Returns
    -------
    SubmissionResult
        One result for every question of the assignment, whatever the submission does.
    """
    ran: tuple[Ran, ...] = ()
    if submission.status == "ready":
        results, ran = _Walk(submission, assets, workshop, folder, pictures).results()
    else:
        reason = "; ".join(submission.notes)
        results = tuple(
            QuestionResult(cell.id, Decimal(0), cell.points or Decimal(0), submission.status, reason)
            for cell in assets.template.questions
        )
    return SubmissionResult(submission.student, submission.assignment, results, ran, submission.notes, workshop.rung)


@dataclass(frozen=True, slots=True)
class Ran:
    """A cell that was gone through: what came back, or how the process died of it."""

    step: Step
    reply: Reply
    death: StudentDied | None = None


_RUN = ("given", "answer", "extra")


class _Walk:
    """One walk through a submission, with what has been learnt on the way."""

    def __init__(
        self, submission: Submission, assets: Assets, workshop: Workshop, folder: Path, pictures: bool
    ) -> None:
        self._submission = submission
        self._assets = assets
        self._workshop = workshop
        self._folder = folder
        self._pictures = pictures
        self._known: dict[str, Value] = {}
        self._replay: list[Step | Mapping[str, Value]] = []
        self._failed: list[str] = []
        self._student = workshop.start(folder)

    def results(self) -> tuple[tuple[QuestionResult, ...], tuple[Ran, ...]]:
        """Go through every cell; one result a question, and every cell with what came of it."""
        points = {cell.id: cell.points or Decimal(0) for cell in self._assets.template.questions}
        found: list[QuestionResult] = []
        gone: list[Ran] = []
        answer: list[Ran] = []
        start = time.monotonic()
        try:
            for step in self._submission.steps:
                ran = self._run(step) if step.code and step.kind in _RUN else Ran(step, Reply(True))
                gone.append(ran)
                if step.kind in ("answer", "extra") and step.code:
                    answer.append(ran)
                if step.kind not in ("question", "manual"):
                    continue
                worth = points[step.id or ""]
                result = self._manual(step, worth) if step.kind == "manual" else self._question(step, worth, answer)
                now = time.monotonic()
                found.append(replace(result, seconds=now - start))
                start, answer = now, []
        finally:
            self._student.close()
        return tuple(found), tuple(gone)

    def _run(self, step: Step) -> Ran:
        try:
            reply = self._student.run(step.source, figures=self._pictures and step.kind != "given")
        except StudentDied as death:
            self._revive()
            return Ran(step, Reply(False), death)
        self._replay.append(step)
        return Ran(step, reply)

    def _manual(self, step: Step, points: Decimal) -> QuestionResult:
        released = next(cell.source for cell in self._assets.template.cells if cell.id == step.id)
        empty = step.source.strip() in ("", released.strip())
        reason = "no answer" if empty else "waits to be graded by hand"
        return QuestionResult(step.id or "", None, points, "manual", reason, answer=step.source)

    def _question(self, step: Step, points: Decimal, ran: list[Ran]) -> QuestionResult:
        question = self._assets.assignment.question(step.id or "")
        ask = self._ask(question)
        death = next((cell.death for cell in ran if cell.death is not None), None)
        if death is None:
            try:
                verdict = question.verdict(ask)
            except StudentDied as died:
                death = died
                self._revive()
            except Exception as error:  # a check must never take the other questions with it
                verdict = Verdict(
                    False, f"This answer could not be judged ({type(error).__name__}). Tell your teacher."
                )
        status = "graded"
        if death is not None:
            status = death.status
            verdict = Verdict(False, f"Your code for this step did not come back: {death}.")
        elif not verdict.passed:
            verdict = _with_error(verdict, ran)
            if any((cell.reply.error or {}).get("kind") == "MemoryError" for cell in ran):
                status = "limit"
        if verdict.passed and (spoilt := [used for used in question.uses if used in self._failed]):
            verdict = replace(verdict, reason=f"{verdict.reason} (Judged on the right values of {', '.join(spoilt)}.)")
        self._carry_forward(question, ask, verdict.passed)
        return QuestionResult(
            question.id,
            points if verdict.passed else Decimal(0),
            points,
            status,
            verdict.reason,
            verdict.slip,
            answer="\n\n".join(cell.step.source for cell in ran),
            output="".join(cell.reply.stdout for cell in ran),
            figures=tuple(figure for cell in ran for figure in cell.reply.figures),
        )

    def _carry_forward(self, question: Question, ask: ProcessAsk, passed: bool) -> None:
        if not passed:
            self._failed.append(question.id)
        try:
            given = given_values(question, ask, passed)
        except StudentDied:
            self._revive()
            given = given_values(question, ask, passed=False)
        except Exception:  # the questions that start from these values will say that they could not be judged
            return
        self._known.update(given)
        if given and not passed:
            self._replay.append(given)
            try:
                self._student.set(given)
            except StudentDied:
                self._revive()

    def _revive(self) -> None:
        """Start another process and bring it to where the last one was, without what killed it."""
        while True:
            self._student.close()
            self._student = self._workshop.start(self._folder)
            for index, done in enumerate(self._replay):
                try:
                    if isinstance(done, Step):
                        self._student.run(done.source)
                    else:
                        self._student.set(done)
                except StudentDied:  # this cell does not survive being run again: go without it
                    del self._replay[index]
                    break
            else:
                return

    def _ask(self, question: Question) -> ProcessAsk:
        identity = f"{self._submission.student}\0{self._submission.assignment}\0{question.id}".encode(
            errors="surrogatepass"
        )
        seed = hmac.new(self._assets.secret, identity, hashlib.sha256).digest()
        return ProcessAsk(lambda: self._student, self._assets.record, self._known, np.random.default_rng(list(seed)))


def _with_error(verdict: Verdict, ran: list[Ran]) -> Verdict:
    """Say first that the cell above stopped, where it did: that is what the student must mend."""
    for cell in ran:
        error = cell.reply.error
        if error is not None:
            line = f" in line {error['line']}" if error.get("line") else ""
            return replace(verdict, reason=f"Your cell stopped{line} with {said(error)}. {verdict.reason}")
    return verdict
