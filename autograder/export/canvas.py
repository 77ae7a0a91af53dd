"""Export of the marks to Canvas, as the CSV file that its gradebook imports.

A gradebook as downloaded gets the marks in the columns of the assignments; all other values stay as they are. Without
one, a new file has the same columns, with the points possible.
"""

import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path

from autograder.course.plain_text import one_line, plain_decimal
from autograder.course.students import Student, known_students
from autograder.export.sums import factors_of, rounded, sum_totals
from autograder.intake.canvas_gradebook import IDENTITY, LOGIN, POINTS, STUDENT, CanvasGradebook, find_students, name_of
from autograder.intake.canvas_gradebook import gradebook_text as text_of
from autograder.results import gradebook, grades, result_files
from autograder.results.grades import Totals, write_grades
from autograder.results.result_files import StoredResult
from labsid._files import csv_text, write_file, write_text

_EXCUSED = "ex"


@dataclass(frozen=True, slots=True)
class CanvasExport:
    """The file written, and remarks for the instructor.

    Attributes
    ----------
    path : Path
    columns : tuple of str
        The columns that have the marks.
    filled : int
        Number of students with marks.
    remarks : tuple of str
    """

    path: Path
    columns: tuple[str, ...]
    filled: int
    remarks: tuple[str, ...]


def export_canvas(
    out: Path,
    book: CanvasGradebook | None,
    *assignments: str,
    column: str | None = None,
    weights: Mapping[str, Decimal] | None = None,
    scale: bool = False,
    zero: bool = False,
) -> CanvasExport:
    """Write ``OUT/canvas/gradebook.csv``.

    Parameters
    ----------
    out : Path
        A folder that ``labsid course grade`` wrote.
    book : CanvasGradebook or None
        As downloaded; without it the file has every student of the class and a new column for each assignment.
    *assignments : str
        Default all graded ones.
    column : str, optional
        The column that gets the sum of the assignments; default for each assignment the column with its name or title.
    weights : mapping, optional
        Marks in the sum, by assignment.
    scale : bool
        Whether to convert the marks to the points possible.
    zero : bool
        Whether students without a hand-in and without a mark get 0 marks; otherwise nothing is written for them.

    Returns
    -------
    CanvasExport

    Raises
    ------
    ValueError
        If OUT has no results of an assignment, there is no column for the marks, its points possible are not their
        sum and they are not to be scaled, or it is not clear who is who; nothing is written then.
    """
    everything = result_files.load_all(out)
    graded = list(dict.fromkeys(result.assignment for result in everything))
    absent = [name for name in assignments if name not in graded]
    if absent or not graded:
        raise ValueError(f"{out} holds no results of {absent[0]!r}." if absent else f"{out} holds no results.")
    stored = [result for result in everything if not assignments or result.assignment in assignments]
    known = known_students(out, {result.student for result in everything})
    targets, remarks = _targets(book, stored, assignments, column)
    marks = {title: _marks_of(out, stored, names, weights or {}) for title, names in targets.items()}
    if book is None:
        rows, filled = _new_rows(known, marks, zero=zero)
        text = csv_text([*IDENTITY, *marks], rows)
    else:
        if not scale:
            _require_points(out, book, marks, assignments, column)
        filled_rows, filled, said = _filled_rows(book, find_students(book, known), marks, zero=zero)
        remarks += said
        text = text_of(book, filled_rows)
    path = out / "canvas" / "gradebook.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    if book is None:
        write_text(path, text)
    else:
        write_file(path, text.encode(errors="backslashreplace"))
    write_grades(out)
    return CanvasExport(path, tuple(marks), filled, tuple(map(one_line, remarks)))


@dataclass(frozen=True, slots=True)
class _Marks:
    """The marks of the class in one column: all marks there are, and those of each student."""

    maximum: Decimal
    by_student: Mapping[str, Totals]


def _marks_of(
    out: Path, stored: Sequence[StoredResult], names: Sequence[str], weights: Mapping[str, Decimal]
) -> _Marks:
    results = [one for one in stored if one.assignment in names]
    factors = factors_of(results, weights)
    manual = gradebook.read_manual_grades(out).scores
    parts: dict[str, list[tuple[Totals, Decimal]]] = {}
    for one in results:
        parts.setdefault(one.student, []).append((grades.totals(one, manual), factors[one.assignment][1]))
    maximum = sum((most * factor for most, factor in factors.values()), Decimal(0))
    return _Marks(maximum, {student: sum_totals(totals) for student, totals in parts.items()})


def _targets(
    book: CanvasGradebook | None, stored: Sequence[StoredResult], assignments: Sequence[str], column: str | None
) -> tuple[dict[str, list[str]], list[str]]:
    """The assignments whose marks go into each column, and remarks on those without one."""
    titles = {result.assignment: one_line(result.title) or result.assignment for result in stored}
    if column is not None:
        place = column if book is None else _only_column(book, column)
        return {place: list(titles)}, []
    if book is None:
        return {title: [name] for name, title in titles.items()}, []
    columns: dict[str, list[str]] = {}
    without_column = []
    for name, title in titles.items():
        named = [
            column for column in book.assignment_columns if _plain(name_of(column)) in (_plain(name), _plain(title))
        ]
        if len(named) > 1:
            raise ValueError(f"{book.path}: {' and '.join(named)} both have the name of {name}. Give --column, too.")
        if not named:
            without_column.append(name)
        else:
            columns.setdefault(named[0], []).append(name)
    if not columns or (assignments and without_column):
        raise ValueError(
            f"{book.path} has no column with the name or title of {', '.join(without_column)}. Its columns are "
            f"{', '.join(map(repr, book.assignment_columns)) or 'none'}. Name the one for the marks: --column NAME"
        )
    return columns, [f"{name}: no column of this gradebook, not written" for name in without_column]


def _only_column(book: CanvasGradebook, wanted: str) -> str:
    """The column that is meant, by its heading or by its name without the number."""
    if wanted in book.assignment_columns:
        return wanted
    named = [one for one in book.assignment_columns if name_of(one) == wanted]
    if len(named) == 1:
        return named[0]
    raise ValueError(
        f"{book.path} has {'several columns' if named else 'no column that can be filled in'} of the name {wanted!r}. "
        f"There are {', '.join(map(repr, book.assignment_columns)) or 'none'}."
    )


def _plain(name: str) -> str:
    return re.sub(r"[^\w]+|_", "", name).casefold()


def _require_points(
    out: Path, book: CanvasGradebook, marks: Mapping[str, _Marks], assignments: Sequence[str], column: str | None
) -> None:
    """Refuse a column whose points are not the marks, and say what to type."""
    for name, of_class in marks.items():
        points = _number(book.points_possible(name))
        if points is None or points == of_class.maximum:
            continue
        command = ["labsid", "course", "export", "--format", "canvas", "--worksheet", str(book.path), "--out", str(out)]
        command += [word for assignment in assignments for word in ("--assignment", assignment)]
        command += ["--column", column] if column is not None else []
        raise ValueError(
            f"{name} is out of {plain_decimal(points)} points in Canvas, but the marks are out of "
            f"{plain_decimal(of_class.maximum)}; nothing was written. Change the points in Canvas and export the "
            f"gradebook again or, to convert the marks, type: {shlex.join([*command, '--scale'])}"
        )


def _filled_rows(
    book: CanvasGradebook, students: Mapping[int, str], marks: Mapping[str, _Marks], *, zero: bool
) -> tuple[list[list[str]], int, list[str]]:
    """The rows with their marks, the number of students who have some, and remarks."""
    rows, remarks, without_hand_in, unknown = [], [], [], []
    filled: set[str] = set()
    for number, old_row in enumerate(book.rows):
        row, student = list(old_row), students.get(number)
        rows.append(row)
        if book.is_test_student(old_row):
            continue
        name = book.value(old_row, STUDENT) or book.value(old_row, LOGIN)
        unknown += [name] if student is None else []
        for column, of_class in marks.items():
            place = book.columns.index(column)
            there = old_row[place].strip()
            total = None if student is None else of_class.by_student.get(student)
            if total is None:
                if not there:
                    without_hand_in.append(name)
                    row[place] = "0" if zero else row[place]
                continue
            filled.add(str(student))
            value = plain_decimal(_scaled(total.score, of_class.maximum, _number(book.points_possible(column))))
            if there.casefold() == _EXCUSED:
                remarks.append(f"{student}: excused in Canvas, and not changed ({column}: {value})")
                continue
            row[place] = value
            remarks += list(_said(str(student), column, there, value, total))
    remarks += [
        f"{student}: not in the gradebook"
        for student in dict.fromkeys(owner for of_class in marks.values() for owner in of_class.by_student)
        if student not in filled
    ]
    if unknown:
        remarks.append(f"not known in this class: {'; '.join(unknown)}")
    if without_hand_in:
        given = "0 marks were given" if zero else "the mark is left empty; --zero gives 0 marks"
        remarks.append(f"nothing handed in ({given}): {'; '.join(dict.fromkeys(without_hand_in))}")
    return rows, len(filled), remarks


def _said(student: str, column: str, there: str, value: str, total: Totals) -> Iterator[str]:
    if there and _number(there) != _number(value):
        yield f"{student}: {column} was {there} in the gradebook and is {value}"
    if total.waiting:
        yield f"{student}: {plain_decimal(total.waiting)} marks not yet graded by hand"


def _new_rows(known: Sequence[Student], marks: Mapping[str, _Marks], *, zero: bool) -> tuple[list[list[str]], int]:
    """The rows of a new gradebook, the points possible first; one for each student."""
    rows = [[f"    {POINTS}", "", "", "", "", *(plain_decimal(column.maximum) for column in marks.values())]]
    people = {student_known.id: student_known for student_known in known}
    filled = 0
    for student, person in people.items():
        totals = [of_class.by_student.get(student) for of_class in marks.values()]
        values = [("0" if zero else "") if total is None else plain_decimal(total.score) for total in totals]
        first, last = person.first_and_last_name
        name = ", ".join(filter(None, (last, first))) or student
        rows.append([name, "", "", person.username or student, "", *values])
        filled += any(total is not None for total in totals)
    return rows, filled


def _scaled(score: Decimal, maximum: Decimal, points: Decimal | None) -> Decimal:
    if points is None or points == maximum or not maximum:
        return score
    return rounded(score * points / maximum)


def _number(text: str) -> Decimal | None:
    """A number of the file, also with a decimal comma; None if there is none."""
    try:
        value = Decimal(text.strip().replace(",", "."))
    except InvalidOperation:
        return None
    return value if value.is_finite() and value >= 0 else None
