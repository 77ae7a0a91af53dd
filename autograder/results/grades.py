"""Marks of submissions, and the table ``grades.csv``."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

from autograder.course.plain_text import one_line, plain_decimal
from autograder.judge.outcome import QuestionResult
from autograder.results import gradebook, result_files
from autograder.results.gradebook import ManualGrades
from autograder.results.result_files import StoredResult
from labsid._files import csv_text, write_text

GRADE_COLUMNS = (
    "student", "assignment", "question", "score", "max_score", "status", "reason", "isolation", "seconds",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Totals:
    """Marks of one submission.

    Attributes
    ----------
    score : Decimal
        Marks awarded, after the late penalty.
    max_score : Decimal
    waiting : Decimal
        Marks of questions not yet graded by hand.
    penalty : Decimal
        Late penalty.
    """

    score: Decimal
    max_score: Decimal
    waiting: Decimal
    penalty: Decimal = Decimal(0)


def totals(result: StoredResult, manual: Mapping[tuple[str, str, str], Decimal]) -> Totals:
    """Add up the marks of a submission; manual scores, by (student, assignment, question), take precedence."""
    score = max_score = waiting = Decimal(0)
    for question in result.questions:
        awarded = manual.get((result.student, result.assignment, question.question), question.score)
        max_score += question.max_score
        score += awarded or Decimal(0)
        waiting += question.max_score if awarded is None else Decimal(0)
    return Totals(max(score - result.penalty, Decimal(0)), max_score, waiting, result.penalty)


def grade_rows(results: Iterable[StoredResult], manual: ManualGrades) -> list[dict[str, str]]:
    """The rows of grades.csv, in the order of students, assignments and questions.

    Parameters
    ----------
    results : iterable of StoredResult
    manual : ManualGrades
        Its scores take precedence.

    Returns
    -------
    list of dict
        One for each question, with the columns of `GRADE_COLUMNS`.
    """
    rows = []
    for result in results:
        for question in result.questions:
            key = result.student, result.assignment, question.question
            by_hand = manual.scores.get(key)
            score = question.score if by_hand is None else by_hand
            rows.append(
                {
                    "student": result.student,
                    "assignment": result.assignment,
                    "question": question.question,
                    "score": "" if score is None else plain_decimal(score),
                    "max_score": plain_decimal(question.max_score),
                    "status": question.status,
                    "reason": one_line(reason_shown(question, key, manual)),
                    "isolation": result.isolation,
                    "seconds": f"{question.seconds:.3f}",
                }
            )
    return rows


def reason_shown(question: QuestionResult, key: gradebook.Key, manual: ManualGrades) -> str:
    """The reason of a question's marks: who gave them and when, if that is known."""
    mark = manual.marks.get(key)
    if mark is not None:
        return mark.text
    by_hand = question.status == "manual" and key in manual.scores
    return "graded by hand" if by_hand else question.reason


def write_csv(path: Path, columns: Iterable[str], rows: Iterable[Mapping[str, str]]) -> None:
    """Write a table atomically; text that a spreadsheet would evaluate as a formula gets an apostrophe."""
    names = list(columns)
    write_text(path, csv_text(names, ([row[name] for name in names] for row in rows)))


def write_grades(out: Path) -> None:
    """Write grades.csv from the results and the manual grades."""
    rows = grade_rows(result_files.load_all(out), gradebook.read_manual_grades(out))
    write_csv(out / "grades.csv", GRADE_COLUMNS, rows)
