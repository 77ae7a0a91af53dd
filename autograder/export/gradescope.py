"""Export of the marks in the columns of Gradescope's own "Download Grades".

Gradescope imports no marks from files: they come from an autograder. Gradebooks and scripts that read the file which
Gradescope writes read this one, too.
"""

from collections.abc import Sequence
from decimal import Decimal
from pathlib import Path

from autograder.course.plain_text import one_line, plain_decimal
from autograder.course.students import known_students
from autograder.results import gradebook, grades, result_files
from autograder.results.grades import write_grades
from autograder.results.result_files import StoredResult
from labsid._files import csv_text, write_text

IDENTITY = ("First Name", "Last Name", "SID", "Email", "Sections")
_PARTS = ("", " - Max Points", " - Submission Time", " - Lateness (H:M:S)")


def export_gradescope(out: Path, *assignments: str) -> tuple[Path, tuple[str, ...]]:
    """Write ``OUT/gradescope/grades.csv``.

    Parameters
    ----------
    out : Path
        A folder that ``labsid course grade`` wrote.
    *assignments : str
        Default all graded ones.

    Returns
    -------
    path : Path
        One row for each student of the class, and four columns for each assignment: marks after the late penalty, all
        marks, time of the hand-in and lateness, which is empty because the penalty has been taken off.
    remarks : tuple of str

    Raises
    ------
    ValueError
        If OUT has no results of an assignment.
    """
    everything = result_files.load_all(out)
    graded = list(dict.fromkeys(entry.assignment for entry in everything))
    absent = [name for name in assignments if name not in graded]
    if absent or not graded:
        raise ValueError(f"{out} holds no results of {absent[0]!r}." if absent else f"{out} holds no results.")
    names = [name for name in graded if not assignments or name in assignments]
    stored_results = {(entry.student, entry.assignment): entry for entry in everything}
    titles = {entry.assignment: one_line(entry.title) or entry.assignment for entry in everything}
    manual = gradebook.read_manual_grades(out).scores
    totals = {key: grades.totals(entry, manual) for key, entry in stored_results.items()}
    most = {name: max(total.max_score for key, total in totals.items() if key[1] == name) for name in names}
    rows: list[Sequence[str]] = []
    people = {someone.id: someone for someone in known_students(out, {someone.student for someone in everything})}
    for student, person in people.items():
        values: list[str] = []
        for name in names:
            result = stored_results.get((student, name))
            score = None if result is None or not _is_handed_in(result) else totals[student, name].score
            values += ["" if score is None else plain_decimal(score), plain_decimal(most[name])]
            values += [(result.submitted or "") if result is not None else "", ""]
        rows.append([*person.first_and_last_name, student, person.email, "", *values])
    columns = [*IDENTITY, *(f"{titles[name]}{part}" for name in names for part in _PARTS)]
    path = out / "gradescope" / "grades.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, csv_text(columns, rows))
    write_grades(out)
    waiting = [key for key, total in totals.items() if key[1] in names and total.waiting > Decimal(0)]
    return path, tuple(
        f"{student}: {plain_decimal(totals[student, name].waiting)} marks of {name} not yet graded by hand"
        for student, name in waiting
    )


def _is_handed_in(result: StoredResult) -> bool:
    return any(question.status != "missing" for question in result.questions)
