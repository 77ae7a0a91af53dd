"""The students of a course: a CSV file with the columns id, name and e-mail, or one ID per line.

The commands write the same kind of file with two more columns, username and participant: who is who, as decided once by
``labsid course release`` or ``collect``; see `autograder.intake.identity`.
"""

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from labsid._files import csv_text, without_apostrophe, write_text

STUDENTS_FILE = "students.csv"
"""Who is who: the table in a folder of submissions and in a folder of results."""

COLUMNS = ("id", "name", "email", "username", "participant")
_WITHOUT_HEADINGS = COLUMNS[:3]
_HEADINGS = {"id": "id", "student": "id", "id number": "id", "name": "name", "full name": "name"}
_HEADINGS |= {"email": "email", "e-mail": "email", "email address": "email"}
_HEADINGS |= {"username": "username", "participant": "participant"}


@dataclass(frozen=True, slots=True)
class Student:
    """One student.

    Attributes
    ----------
    id : str
        As in the names of folders.
    name, email : str
        Empty if unknown.
    username, participant : str
        The name with which one logs in, and the number in one assignment of the learning platform; empty if unknown.
    """

    id: str
    name: str = ""
    email: str = ""
    username: str = ""
    participant: str = ""

    @property
    def first_and_last_name(self) -> tuple[str, str]:
        """The parts of ``Ada Lovelace`` or ``Lovelace, Ada``; the last word is the last name."""
        last, comma, first = self.name.partition(",")
        if not comma:
            first, _, last = self.name.strip().rpartition(" ")
        return first.strip(), last.strip()


def read_students(path: Path) -> list[Student]:
    """Read students, one per line; empty lines and lines that start with # are skipped.

    Parameters
    ----------
    path : Path
        CSV in UTF-8, separated by commas or semicolons. The columns are id, name and e-mail; with a line of headings,
        in any order and beside others. A student may have several lines with different participant numbers.

    Raises
    ------
    ValueError
        If there is no ID, one twice, also in other case, or a line has too many columns.
    """
    try:
        lines = [line for line in path.read_text(encoding="utf-8-sig").splitlines() if line.strip()]
    except UnicodeDecodeError:
        raise ValueError(f"{path} is not text in UTF-8. Expected one student ID per line, or CSV.") from None
    lines = [line for line in lines if not line.lstrip().startswith("#")]
    separator = ";" if lines and ";" in lines[0] else ","
    rows = [[value.strip() for value in row] for row in csv.reader(lines, delimiter=separator, skipinitialspace=True)]
    headings = [_HEADINGS.get(value.casefold(), "") for value in rows[0]] if rows else []
    if "id" in headings:
        del rows[0]
    else:
        headings = list(_WITHOUT_HEADINGS)
    students = []
    for row in rows:
        if len(row) > len(headings):
            raise ValueError(
                f"{path}: got {len(row)} columns in {separator.join(row)!r}, expected id, name and e-mail."
            )
        values = {heading: without_apostrophe(value) for heading, value in zip(headings, row, strict=False) if heading}
        if values.get("id"):
            students.append(Student(**values))
    if not students:
        raise ValueError(f"{path} names no students. Expected one student ID per line.")
    _refuse_equal_ids(path, students)
    return students


def _refuse_equal_ids(path: Path, students: Sequence[Student]) -> None:
    first: dict[tuple[str, str], Student] = {}
    spelled: dict[str, Student] = {}
    for student in students:
        key = student.id.casefold()
        other = spelled.setdefault(key, student)
        if other.id != student.id:
            raise ValueError(
                f"{path} names {described(other)} and {described(student)}, whose IDs differ only in upper and lower "
                "case. Correct one of them."
            )
        if first.setdefault((key, student.participant), student) is not student:
            raise ValueError(f"{path} names {student.id} twice.")


def described(student: Student) -> str:
    """A student in a message: name and ID."""
    return f"{student.name} ({student.id})" if student.name else student.id


def write_students(path: Path, students: Iterable[Student]) -> None:
    """Write students as CSV with a line of headings."""
    rows = ([getattr(student, column) for column in COLUMNS] for student in students)
    write_text(path, csv_text(COLUMNS, rows))


def known_students(folder: Path, ids: Iterable[str]) -> list[Student]:
    """The students of the table in a folder, and those of other IDs."""
    path = folder / STUDENTS_FILE
    return merge_students([Student(one) for one in ids], read_students(path) if path.is_file() else [])


def merge_students(*lists: Sequence[Student]) -> list[Student]:
    """The students of all lists, by ID and participant number; a later list counts where it has a name.

    What one list does not know of a student is taken from the others.
    """
    merged: dict[str, Student] = {}
    numbers: dict[str, set[str]] = {}
    for student in (student for students in lists for student in students):
        before = merged.get(student.id, student)
        newer, older = (student, before) if student.name else (before, student)
        merged[student.id] = replace(newer, **{name: getattr(newer, name) or getattr(older, name) for name in COLUMNS})
        numbers.setdefault(student.id, set()).add(student.participant)
    return [
        replace(merged[student], participant=number)
        for student in sorted(merged)
        for number in sorted(numbers[student] - {""} or {""})
    ]
