"""The students of a course: a CSV file with the columns id, name and e-mail, or one ID per line."""

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from labsid._files import write_text

COLUMNS = ("id", "name", "email")
_HEADINGS = {"id": "id", "student": "id", "id number": "id", "name": "name", "full name": "name"}
_HEADINGS |= {"email": "email", "e-mail": "email", "email address": "email"}


@dataclass(frozen=True, slots=True)
class Student:
    """One student.

    Attributes
    ----------
    id : str
        As in the names of folders.
    name, email : str
        Empty if unknown.
    """

    id: str
    name: str = ""
    email: str = ""

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
        in any order and beside others.

    Raises
    ------
    ValueError
        If there is no ID, a duplicate, or a line with too many columns.
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
        headings = list(COLUMNS)
    students = []
    for row in rows:
        if len(row) > len(headings):
            raise ValueError(
                f"{path}: got {len(row)} columns in {separator.join(row)!r}, expected id, name and e-mail."
            )
        values = {heading: value for heading, value in zip(headings, row, strict=False) if heading}
        if values.get("id"):
            students.append(Student(**values))
    if not students:
        raise ValueError(f"{path} names no students. Expected one student ID per line.")
    ids = [student.id for student in students]
    twice = sorted({student for student in ids if ids.count(student) > 1})
    if twice:
        raise ValueError(f"{path} names {', '.join(twice)} twice.")
    return students


def write_students(path: Path, students: Iterable[Student]) -> None:
    """Write students as CSV with a line of headings."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows((student.id, student.name, student.email) for student in students)
    write_text(path, text.getvalue())


def merge_students(*lists: Sequence[Student]) -> list[Student]:
    """The students of all lists, by ID; a later list counts where it has a name."""
    merged: dict[str, Student] = {}
    for student in (student for students in lists for student in students):
        if student.name or student.id not in merged:
            merged[student.id] = student
    return [merged[key] for key in sorted(merged)]
