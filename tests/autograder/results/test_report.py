"""The class report: what an instructor may give marks for."""

from decimal import Decimal

from autograder.judge.outcome import QuestionResult
from autograder.results.gradebook import ManualGrades
from autograder.results.report import report_page
from autograder.results.result_files import StoredResult


def test_what_follows_from_own_wrong_values_is_listed_with_its_marks() -> None:
    questions = (
        QuestionResult("q-1", Decimal(0), Decimal("0.5"), "graded", "Wrong."),
        QuestionResult("q-2", Decimal(0), Decimal("0.1"), "graded", "Wrong.", consistent=True),
        QuestionResult("q-3", Decimal(0), Decimal("0.15"), "graded", "Wrong.", consistent=True),
        QuestionResult("q-4", Decimal(1), Decimal(1), "graded", "Right."),
    )
    stored = StoredResult("ada", "tiny", "Tiny", questions, {}, (), "none", {})
    (review,) = report_page([stored], ManualGrades({}, {}, frozenset()))["reviews"]
    assert review["reasons"] == [
        "consistent with the student's own wrong values, 0.25 marks that you may give: q-2 (0.1), q-3 (0.15)"
    ]
