"""Judge one submission: run its cells, read its variables and compare them with labsid in this process.

The student's processes run the cells. Only this process holds the checks, the reference and the hidden inputs on which
functions are tested.

A wrong answer costs its own question alone. So an answer that follows from wrong ones is judged until it is right: on
the student's own values of the earlier steps; against what their right values give; and in a second run, in which
right values and functions replace the wrong ones.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from pathlib import Path

from autograder.intake.submission import NotebookCell, Submission
from autograder.judge.answer import Answer, wrong_steps
from autograder.judge.ask import AskOpener
from autograder.judge.attempt import Attempt
from autograder.judge.carrying import differ_in_shape, is_usable
from autograder.judge.examiner import Examination, Examiner
from autograder.judge.execution import ExecutedCell, Execution
from autograder.judge.outcome import QuestionResult, SubmissionResult, ungraded_result
from autograder.judge.own_tests import OwnTests
from autograder.judge.picture import figure_svg
from autograder.judge.second_run import SecondRun
from autograder.judge.used_demonstrations import with_used_demonstrations
from autograder.sandbox.isolation import ProcessLauncher
from labsid.checks.cells import Template
from labsid.checks.question import Assignment, Origin
from labsid.checks.values import Value
from labsid.plots.figure_values import FigureValue
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
    functions : mapping
        Source of the right functions, by the question that asks for them.
    tests : mapping
        Source of the test cells of nbgrader that have hidden tests, by question.
    """

    template: Template
    assignment: Assignment
    record: Record | None
    secret: bytes = field(repr=False)
    origin: Origin | None = None
    functions: Mapping[str, str] = field(default_factory=dict)
    tests: Mapping[str, str] = field(default_factory=dict, repr=False)


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
    submission = replace(submission, cells=with_used_demonstrations(submission.cells))
    judge = _SubmissionJudge(submission, assets, launcher, folder, pictures)
    results = judge.run()
    wrong = {answer.question.id: answer.own for answer in judge.answers if not answer.is_right and answer.own}
    return SubmissionResult(
        submission.student,
        submission.assignment,
        results,
        tuple(judge.executed),
        submission.notes,
        launcher.level,
        wrong,
    )


class _SubmissionJudge:
    """Judges one submission.

    Attributes
    ----------
    executed : list of ExecutedCell
        Every cell, with its output in the notebook as it was handed in.
    answers : list of Answer
        The answers to the questions that checks grade.
    tests : list of OwnTests
        The questions that nbgrader's own tests grade.
    """

    def __init__(
        self, submission: Submission, assets: Assets, launcher: ProcessLauncher, folder: Path, pictures: bool
    ) -> None:
        self._submission = submission
        self._assets = assets
        self._launcher = launcher
        self._folder = folder
        self._pictures = pictures
        self._points = {cell.id: cell.points or Decimal(0) for cell in assets.template.questions}
        source = "\n".join(cell.source for cell in submission.cells)
        self._asks = AskOpener(
            submission.student, submission.assignment, source, assets.record, assets.origin, assets.secret
        )
        self.executed: list[ExecutedCell] = []
        self.answers: list[Answer] = []
        self.tests: list[OwnTests] = []

    def run(self) -> tuple[QuestionResult, ...]:
        """Run and judge all cells; returns a result for each question."""
        execution = Execution(self._launcher, self._folder)
        examiner = Examiner(execution, self._asks, self._launcher.limits)
        try:
            entries = self._run_cells(execution, examiner)
            self._judge_the_rest(examiner)
            for tests in self.tests:
                tests.run_hidden(execution, self._launcher.limits)
        finally:
            execution.close()
        second_run = SecondRun(
            self.executed, self.answers, self._assets.functions, self._asks, self._launcher, self._folder
        )
        second_run.judge(time.monotonic() + self._launcher.limits.submission_seconds)  # not on the notebook's time
        return tuple(entry if isinstance(entry, QuestionResult) else entry.result() for entry in entries)

    def _run_cells(self, execution: Execution, examiner: Examiner) -> list[Answer | OwnTests | QuestionResult]:
        """Run all cells, and judge at each question what can be judged there."""
        entries: list[Answer | OwnTests | QuestionResult] = []
        own: dict[str, Value] = {}
        right: dict[str, Value] = {}
        cells: list[ExecutedCell] = []
        start = time.monotonic()
        for cell in self._submission.cells:
            done = execution.run(cell)
            self.executed.append(done)
            if cell.kind in ("answer", "extra") and cell.code:
                cells.append(done)
            if cell.kind == "manual":
                entries.append(replace(self._manual(cell), seconds=time.monotonic() - start))
            elif cell.kind == "question":
                answer = self._question(cell, cells, own, right, examiner)
                own.update(answer.carried)
                is_wrong = bool(answer.attempts) and not answer.is_right
                right.update(answer.right if is_wrong else answer.carried)
                answer.seconds = time.monotonic() - start
                self.answers.append(answer)
                entries.append(answer)
            elif cell.kind == "tests":
                hidden = self._assets.tests.get(cell.id or "", "")
                key = -1 - len(self.tests)  # the keys from 0 are those of the answers
                tests = OwnTests(key, self._points[cell.id or ""], done, cells, hidden)
                tests.read_visible(execution)
                tests.seconds = time.monotonic() - start
                self.tests.append(tests)
                entries.append(tests)
            else:
                continue
            start, cells = time.monotonic(), []
        return entries

    def _manual(self, cell: NotebookCell) -> QuestionResult:
        released = next(known.source for known in self._assets.template.cells if known.id == cell.id)
        empty = cell.source.strip() in ("", released.strip())
        score, reason = (Decimal(0), "no answer") if empty else (None, "not yet graded by hand")
        points = self._points[cell.id or ""]
        return QuestionResult(cell.id or "", score, points, "manual", reason, answer="" if empty else cell.source)

    def _question(
        self,
        cell: NotebookCell,
        cells: list[ExecutedCell],
        own: Mapping[str, Value],
        right: Mapping[str, Value],
        examiner: Examiner,
    ) -> Answer:
        """The answer to a question, judged on the student's own values unless its check calls a function."""
        asked = Examination(len(self.answers), self._assets.assignment.question(cell.id or ""), cells)
        answer = Answer(asked, self._points[cell.id or ""], dict(own))
        failure = next((done.failure for done in cells if done.failure is not None), None)
        attempt = examiner.judge_now(asked, own) if failure is None else Attempt(None, failure)
        if attempt is not None:
            answer.attempts.append(attempt)
        figures = [value for value in asked.values.values() if isinstance(value, FigureValue)]
        answer.pictures = tuple(map(figure_svg, figures)) if self._pictures else ()
        # values of the wrong kind have no right ones that follow from them
        answer.right = examiner.right_values(asked, own) or examiner.right_values(asked, right)
        if attempt is None or attempt.failure is None:  # a value that ends the process is not read again
            answer.own = examiner.own_values(asked, answer.right)
        return answer

    def _judge_the_rest(self, examiner: Examiner) -> None:
        """Judge functions, now that no later output can reveal hidden inputs, and answers after a wrong one again."""
        right: dict[str, Value] = {}
        for answer in self.answers:
            start = time.monotonic()
            uses = answer.question.uses
            wrong = [other for other in self.answers if other.question.id in uses and not other.is_sound]
            if not answer.attempts:
                answer.attempts.append(examiner.judge_later(answer.asked, answer.known))
            if wrong and not answer.crashed:
                answer.is_sound = _judge_beside_wrong(answer, wrong, right, examiner)
            else:
                answer.is_sound = answer.is_right
            right.update(answer.carried if answer.is_sound else examiner.right_values(answer.asked, right))
            answer.seconds += time.monotonic() - start


def _judge_beside_wrong(
    answer: Answer, wrong: Sequence[Answer], right: Mapping[str, Value], examiner: Examiner
) -> bool:
    """Judge an answer that starts from wrong ones: on the student's values, then against what right values give.

    Returns
    -------
    bool
        Whether it is right by right values.
    """
    causes = wrong_steps(wrong)
    steps = ", ".join(causes)
    on_own = f"(Judged on your own values of {steps}, which are wrong.)"
    allows_own = answer.question.allows_wrong_values and all(is_usable(other.own, other.right) for other in wrong)
    as_columns = any(differ_in_shape(other.own, other.right) for other in wrong)
    first = answer.attempts.pop()
    if allows_own and not first.passed and as_columns:
        first = examiner.judge_later(answer.asked, answer.known, as_columns)
    if allows_own or not first.passed:
        answer.attempts.append(first.noted(on_own, ""))
    if answer.is_right:
        answer.causes = causes
        return False
    second = examiner.judge_later(answer.asked, right, as_columns)
    answer.attempts.append(second.noted("", f"Judged on the right values of {steps}:"))
    return answer.is_right
