"""Export of the marks as CSV."""

from pathlib import Path

from autograder.course.plain_text import plain_decimal
from autograder.results import gradebook, grades, result_files
from autograder.results.grades import write_grades

COLUMNS = ("student", "assignment", "score", "max_score", "waiting", "status", "late_penalty")


def export_csv(out: Path) -> Path:
    """Write ``OUT/export.csv``, one row for each student and assignment, and update ``OUT/grades.csv``.

    Parameters
    ----------
    out : Path
        A folder that ``labsid course grade`` wrote.

    Returns
    -------
    Path
        Columns ``student, assignment, score, max_score, waiting, status, late_penalty``: `score` is after the late
        penalty, `waiting` are marks not yet graded by hand, and `status` is ``complete``, ``waiting``, ``missing`` or
        ``quarantined``.
    """
    manual = gradebook.read_manual_grades(out).scores
    rows = []
    for result in result_files.load_all(out):
        marks = grades.totals(result, manual)
        refused = {question.status for question in result.questions} & {"missing", "quarantined"}
        rows.append(
            {
                "student": result.student,
                "assignment": result.assignment,
                "score": plain_decimal(marks.score),
                "max_score": plain_decimal(marks.max_score),
                "waiting": plain_decimal(marks.waiting),
                "status": refused.pop() if refused else "waiting" if marks.waiting else "complete",
                "late_penalty": plain_decimal(marks.penalty),
            }
        )
    write_grades(out)
    path = out / "export.csv"
    grades.write_csv(path, COLUMNS, rows)
    return path
