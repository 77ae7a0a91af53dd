"""Extensions: own due dates of single students, from a file that `course.toml` or `--extensions` names.

::

    student,assignment,due
    z5123456,lab-identification,2026-12-04T23:59

A line for each student and assignment. `due` is in the time zone of the course, or has an offset. The late rule of the
assignment, with its grace, then counts from this date for this student.
"""

import csv
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from autograder.course.settings import local_time, time_zone
from labsid._files import csv_text, write_text

EXTENSIONS_FILE = "extensions.csv"
"""In OUT: the extensions with which it was graded."""

COLUMNS = ("student", "assignment", "due")


@dataclass(frozen=True, slots=True)
class Extension:
    """The own due date of one student for one assignment.

    Attributes
    ----------
    due : datetime
        In UTC.
    text : str
        The same for students, in the time zone of the course.
    """

    due: datetime
    text: str


Extensions = Mapping[tuple[str, str], Extension]
"""By student and assignment."""


def read_extensions(
    path: Path, assignments: Collection[str], zone_name: str | None = None
) -> dict[tuple[str, str], Extension]:
    """Read a file of extensions.

    Parameters
    ----------
    path : Path
        CSV with the columns ``student, assignment, due``, separated by commas or semicolons.
    assignments : collection of str
        Names of the course's assignments.
    zone_name : str, optional
        Time zone of dates without an offset; default UTC.

    Raises
    ------
    ValueError
        If the file is not such a table, names an unknown assignment, or a student twice for one assignment.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise ValueError(f"{path} is not text in UTF-8. Expected CSV with the columns {', '.join(COLUMNS)}.") from None
    separator = ";" if lines and ";" in lines[0] else ","
    rows = [[value.strip() for value in row] for row in csv.reader(lines, delimiter=separator)]
    if not rows or [heading.casefold() for heading in rows[0]] != list(COLUMNS):
        got = separator.join(rows[0]) if rows else ""
        raise ValueError(f"{path}: got the columns {got!r}, expected {','.join(COLUMNS)} in the first line.")
    zone = UTC if zone_name is None else time_zone(zone_name)
    by_student: dict[tuple[str, str], Extension] = {}
    for number, row in enumerate(rows[1:], 2):
        if not any(row) or row[0].startswith("#"):
            continue
        if len(row) != len(COLUMNS) or not all(row):
            raise ValueError(f"{path}, line {number}: got {separator.join(row)!r}, expected {','.join(COLUMNS)}.")
        student, assignment, due = row
        if assignment not in assignments:
            raise ValueError(
                f"{path}, line {number}: there is no assignment {assignment!r}; there are {', '.join(assignments)}."
            )
        if (student, assignment) in by_student:
            raise ValueError(f"{path}, line {number}: a second extension of {student} for {assignment}; keep one.")
        try:
            when = datetime.fromisoformat(due)
            when = (when if when.tzinfo is not None else when.replace(tzinfo=zone)).astimezone(UTC)
        except (ValueError, OverflowError):
            raise ValueError(
                f"{path}, line {number}: due {due!r} is not a time; expected a value such as 2026-12-04T23:59."
            ) from None
        by_student[student, assignment] = Extension(when, local_time(when, zone_name))
    return by_student


def write_extensions(path: Path, extensions: Extensions) -> None:
    """Write extensions, with dates in UTC."""
    rows = ([student, assignment, one.due.isoformat()] for (student, assignment), one in extensions.items())
    write_text(path, csv_text(COLUMNS, rows))


def extension_remarks(
    extensions: Extensions,
    students: Collection[str],
    assignments: Collection[str],
    due: Mapping[str, datetime],
    now: datetime,
) -> list[str]:
    """What an instructor may not expect of the extensions of a class that is graded.

    Parameters
    ----------
    extensions : mapping
    students, assignments : collection of str
        Those that are graded.
    due : mapping
        The due date of everybody, by assignment; that of all other assignments has an empty name.
    now : datetime
    """
    remarks = []
    for (student, assignment), extension in extensions.items():
        who = f"extension of {student} for {assignment}"
        if student not in students:
            remarks.append(f"{who}: there is no folder of this student; check the ID.")
        elif (everybody := due.get(assignment, due.get(""))) is not None and extension.due < everybody:
            remarks.append(f"{who}: {extension.text} is before the due date of everybody; check it.")
        elif assignment in assignments and extension.due > now:
            remarks.append(f"{who}: runs until {extension.text}; grade again after that.")
    return remarks


def closed_assignments(due: Mapping[str, datetime], extensions: Extensions, now: datetime) -> frozenset[str]:
    """The assignments that nobody works on any more: due, also for the students with an extension.

    Parameters
    ----------
    due : mapping
        The due date of everybody, by assignment.
    extensions : mapping
    now : datetime
    """
    running = {assignment for (_, assignment), one in extensions.items() if one.due > now}
    return frozenset(name for name, when in due.items() if when <= now and name not in running)
