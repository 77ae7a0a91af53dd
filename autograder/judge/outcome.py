"""What comes of judging: a line for each question, and everything known of a submission."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal

from autograder.course.layout import Template
from autograder.intake.submission import Submission
from autograder.judge.execution import ExecutedCell
from labsid.checks.values import Value


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
        Pictures of the figures that were judged, as SVG in base64.
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
        The level on which it ran.
    wrong : mapping
        Of the questions that failed, the values that stood where later steps start from, by question and name.
    flags : tuple of str
        What the teacher alone should know.
    """

    student: str
    assignment: str
    results: tuple[QuestionResult, ...]
    ran: tuple[ExecutedCell, ...]
    notes: tuple[str, ...]
    isolation: str
    wrong: Mapping[str, Mapping[str, Value]] = field(default_factory=dict)
    flags: tuple[str, ...] = ()


def ungraded_result(submission: Submission, template: Template, level: str) -> SubmissionResult:
    """What comes of a submission that is missing or quarantined: no marks for any question, and why."""
    reason = "; ".join(submission.notes)
    results = tuple(
        QuestionResult(cell.id, Decimal(0), cell.points or Decimal(0), submission.status, reason)
        for cell in template.questions
    )
    return SubmissionResult(submission.student, submission.assignment, results, (), submission.notes, level)
