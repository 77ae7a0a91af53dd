"""Results of judging: of a question, and of a submission."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal

from autograder.intake.submission import Submission
from autograder.judge.execution import ExecutedCell
from labsid.checks.cells import Template
from labsid.checks.values import Value


@dataclass(frozen=True, slots=True)
class QuestionResult:
    """The result of one question.

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
        Explanation for the student.
    slip : str or None
        Name of the known mistake that the answer matches.
    answer : str
        The student's own text or code for this question.
    output : str
        Printed output of the answer's cells.
    figures : tuple of str
        The judged figures, as SVG in base64.
    seconds : float
        Time to run its cells and judge the answer.
    consistent : bool
        Whether it is wrong, but follows from the student's own values of earlier steps: an instructor may give marks.
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
    consistent: bool = False


@dataclass(frozen=True, slots=True)
class SubmissionResult:
    """The result of one submission.

    Attributes
    ----------
    student, assignment : str
    results : tuple of QuestionResult
        One for each question, in the order of the notebook.
    cells : tuple of ExecutedCell
        All cells with their output.
    notes : tuple of str
        What was repaired in the submission, or why it was not graded.
    isolation : str
        The isolation level at which it ran.
    wrong_values : mapping
        The student's values that were replaced after a wrong answer, by question and name.
    flags : tuple of str
        Remarks for the instructor only.
    second_record : {"", "run", "off"}
        Whether its answers were tried on another record; empty if nothing in it follows from the record.
    """

    student: str
    assignment: str
    results: tuple[QuestionResult, ...]
    cells: tuple[ExecutedCell, ...]
    notes: tuple[str, ...]
    isolation: str
    wrong_values: Mapping[str, Mapping[str, Value]] = field(default_factory=dict)
    flags: tuple[str, ...] = ()
    second_record: str = ""


def ungraded_result(submission: Submission, template: Template, level: str) -> SubmissionResult:
    """The result of a missing or quarantined submission: no marks, with the reason."""
    reason = "; ".join(submission.notes)
    results = tuple(
        QuestionResult(cell.id, Decimal(0), cell.points or Decimal(0), submission.status, reason)
        for cell in template.questions
    )
    return SubmissionResult(submission.student, submission.assignment, results, (), submission.notes, level)
