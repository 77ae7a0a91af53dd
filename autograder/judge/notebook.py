"""Judge one notebook on one record: run its cells, read its variables and compare them with labsid in this process.

A wrong answer costs its own question alone. So an answer that follows from wrong ones is judged until it is right: in
the notebook as it was handed in, against what right values of the earlier steps give; and in a second run, in which
right values and functions replace the wrong ones. The student's own wrong values count only where a known slip gives
them, its question says that it `carries`, and the answer changes with them.
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
from autograder.judge.carrying import differ_in_shape
from autograder.judge.examiner import Examination, Examiner
from autograder.judge.execution import ExecutedCell, Execution
from autograder.judge.outcome import QuestionResult
from autograder.judge.own_tests import OwnTests
from autograder.judge.picture import figure_svg
from autograder.judge.second_run import SecondRun
from autograder.judge.served_functions import RightFunctions
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
    second_record : bool
        Whether the course tries answers on records that nobody has seen.
    """

    template: Template
    assignment: Assignment
    record: Record | None
    secret: bytes = field(repr=False)
    origin: Origin | None = None
    functions: Mapping[str, str] = field(default_factory=dict)
    tests: Mapping[str, str] = field(default_factory=dict, repr=False)
    second_record: bool = True


@dataclass(frozen=True, slots=True)
class JudgedNotebook:
    """A notebook as it was judged on one record.

    Attributes
    ----------
    executed : tuple of ExecutedCell
        Every cell, with its output in the notebook as it was handed in.
    entries : tuple of Answer, OwnTests or QuestionResult
        One for each question, in the order of the notebook: answers that checks judge, questions that nbgrader's own
        tests judge, and questions that are marked by hand.
    """

    executed: tuple[ExecutedCell, ...]
    entries: tuple[Answer | OwnTests | QuestionResult, ...]

    @property
    def answers(self) -> tuple[Answer, ...]:
        """The answers that checks judge."""
        return tuple(entry for entry in self.entries if isinstance(entry, Answer))

    def results(self) -> tuple[QuestionResult, ...]:
        """A result for each question."""
        return tuple(entry if isinstance(entry, QuestionResult) else entry.result() for entry in self.entries)

    def wrong_values(self) -> dict[str, Mapping[str, Value]]:
        """The student's values that were replaced after a wrong answer, by question and name."""
        return {answer.question.id: answer.own for answer in self.answers if not answer.is_right and answer.own}


def judge_notebook(
    submission: Submission, assets: Assets, launcher: ProcessLauncher, folder: Path, pictures: bool = True
) -> JudgedNotebook:
    """Run a notebook on one record and judge it.

    Its processes follow one another, and all have ended when it returns.

    Parameters
    ----------
    submission : Submission
        Ready to be judged.
    assets : Assets
    launcher : ProcessLauncher
        Starts the student's processes.
    folder : Path
        Work folder of these processes; it contains the record of `assets`.
    pictures : bool
        Whether to draw the figures that are judged, for the feedback.

    Returns
    -------
    JudgedNotebook
    """
    submission = replace(submission, cells=with_used_demonstrations(submission.cells))
    return _NotebookJudge(submission, assets, launcher, folder, pictures).judge()


class _NotebookJudge:
    """Judges one notebook.

    Attributes
    ----------
    executed : list of ExecutedCell
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

    def judge(self) -> JudgedNotebook:
        """Run the notebook as it was handed in, then with right values and functions in the place of wrong ones."""
        execution = Execution(self._launcher, self._folder)
        examiner = Examiner(execution, self._asks, self._launcher.limits)
        try:
            entries = self._run_cells(execution, examiner)
            self._judge_the_rest(examiner)
            for tests in self.tests:
                tests.run_hidden(execution, self._launcher.limits)
        finally:
            execution.close()
        functions = RightFunctions(self._assets.template, self._assets.functions, self._launcher, self._folder)
        second_run = SecondRun(self.executed, self.answers, functions, self._asks, self._launcher, self._folder)
        second_run.judge(time.monotonic() + self._launcher.limits.submission_seconds)  # not on the notebook's time
        return JudgedNotebook(tuple(self.executed), tuple(entries))

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
        answer.pictures = tuple(filter(None, map(figure_svg, figures))) if self._pictures else ()
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
            wrong = [answer for answer in self.answers if answer.question.id in uses and not answer.is_sound]
            if not answer.attempts:
                answer.attempts.append(examiner.judge_later(answer.asked, answer.known))
            if wrong and not answer.crashed:
                answer.is_sound = _judge_beside_wrong(answer, wrong, right, examiner)
            else:
                if any(attempt.broken for attempt in answer.attempts) and not answer.crashed:
                    answer.attempts = [examiner.judge_later(answer.asked, right)]  # the student's own lack a value
                answer.is_sound = answer.is_right
            if not answer.right:  # none followed from the student's own, some of which no check had judged by then
                answer.follow_right(examiner.right_values(answer.asked, right))
            right.update(answer.accepted if answer.is_right else examiner.right_values(answer.asked, right))
            answer.seconds += time.monotonic() - start


def _judge_beside_wrong(
    answer: Answer, wrong: Sequence[Answer], right: Mapping[str, Value], examiner: Examiner
) -> bool:
    """Judge an answer that starts from wrong ones: on the student's values, and against what right values give.

    Returns
    -------
    bool
        Whether it is right by right values, in a shape from which later steps can start.
    """
    steps = ", ".join(wrong_steps(wrong))
    as_columns = any(differ_in_shape(replacement.own, replacement.right) for replacement in wrong)
    first = answer.attempts.pop()
    if not first.passed and as_columns:
        first = examiner.judge_later(answer.asked, answer.known, as_columns)
    answer.follows_own = first.passed
    if not first.passed:
        answer.attempts.append(first)
    second = examiner.judge_later(answer.asked, right, as_columns)
    answer.attempts.append(second.noted("", f"Judged on the right values of {steps}:"))
    return answer.is_right and not (as_columns and differ_in_shape(answer.own, answer.right))
