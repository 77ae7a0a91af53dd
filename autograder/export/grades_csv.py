"""Export of the marks as CSV."""

from decimal import Decimal
from pathlib import Path

from autograder.course.plain_text import plain_decimal
from autograder.course.students import known_students
from autograder.results import gradebook, grades, result_files
from autograder.results.grades import write_grades

COLUMNS = ("student", "assignment", "score", "max_score", "waiting", "status", "late_penalty")


def export_csv(out: Path) -> Path:
    """Write ``OUT/export.csv``, one row for each student and assignment, and update ``OUT/grades.csv``.

    Parameters
    ----------
    out : Path
        A folder that ``labsid course grade`` wrote. Who is in its table of students and has no result at all has 0
        marks and the status ``missing``.

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
    most: dict[str, Decimal] = {}
    for row in rows:
        most[row["assignment"]] = max(Decimal(row["max_score"]), most.get(row["assignment"], Decimal(0)))
    graded = {row["student"] for row in rows}
    for student in dict.fromkeys(person.id for person in known_students(out, graded)):
        if student not in graded:
            rows += [_without_hand_in(student, name, marks) for name, marks in most.items()]
    write_grades(out)
    path = out / "export.csv"
    grades.write_csv(path, COLUMNS, rows)
    return path


def _without_hand_in(student: str, assignment: str, max_score: Decimal) -> dict[str, str]:
    nothing = dict.fromkeys(("score", "waiting", "late_penalty"), "0")
    identity = {"student": student, "assignment": assignment}
    return {**identity, "max_score": plain_decimal(max_score), "status": "missing", **nothing}
