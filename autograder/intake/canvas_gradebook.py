"""The gradebook of Canvas as a CSV file: read it, match its rows to students, and format it.

A file has the columns Student, ID, SIS User ID, SIS Login ID and Section, then one of each assignment, called
``Name (number)``, and columns that Canvas computes. Before the students, a row says how many points are possible.
"""

import csv
import io
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from autograder.course.plain_text import one_line
from autograder.course.students import Student, described
from autograder.intake.worksheet import EMAIL, FULL_NAME, ID_COLUMNS, IDENTIFIER, USERNAME, Worksheet
from labsid._files import as_text_cell

STUDENT, USER, SIS_USER, LOGIN, SECTION = "Student", "ID", "SIS User ID", "SIS Login ID", "Section"
IDENTITY = (STUDENT, USER, SIS_USER, LOGIN, SECTION)
_OTHER_IDENTITY = ("Integration ID", "Root Account", "Notes")
POINTS = "Points Possible"
_COLUMNS = (IDENTIFIER, FULL_NAME, EMAIL, ID_COLUMNS[0], USERNAME)
_READ_ONLY = "(read only)"
_TEST_STUDENT = "student, test"
_NUMBER = re.compile(r"\s*\(\d{1,18}\)$", re.ASCII)
_AGAIN = "Download it again: in Canvas, Grades, Export, Export Entire Gradebook."


@dataclass(frozen=True, slots=True)
class CanvasGradebook:
    """A gradebook as downloaded.

    Attributes
    ----------
    columns : tuple of str
    above : tuple of tuple of str
        The rows before the students, the points among them.
    rows : tuple of tuple of str
        One for each student.
    separator, line_end, bom : str
        How the file is written.
    path : Path
        The file, for messages.
    """

    columns: tuple[str, ...]
    above: tuple[tuple[str, ...], ...]
    rows: tuple[tuple[str, ...], ...]
    separator: str
    line_end: str
    bom: str
    path: Path

    def value(self, row: Sequence[str], column: str) -> str:
        """What stands in a column of a row; empty without that column."""
        return row[self.columns.index(column)].strip() if column in self.columns else ""

    @property
    def assignment_columns(self) -> tuple[str, ...]:
        """The columns that an import can change."""
        taken = (*IDENTITY, *_OTHER_IDENTITY)
        return tuple(name for name in self.columns if name not in taken and not self._is_read_only(name))

    def points_possible(self, column: str) -> str:
        """The points of a column, as text; empty if the file does not say."""
        return next((self.value(row, column) for row in self.above if self._is_points(row)), "")

    def is_test_student(self, row: Sequence[str]) -> bool:
        """Whether a row is that of the student whom Canvas makes for trying out a course."""
        return self.value(row, STUDENT).casefold() == _TEST_STUDENT

    def _is_points(self, row: Sequence[str]) -> bool:
        return self.value(row, STUDENT).casefold() == POINTS.casefold()

    def _is_read_only(self, column: str) -> bool:
        return any(self.value(row, column).casefold() == _READ_ONLY for row in self.above)


def read_gradebook(path: Path) -> CanvasGradebook:
    """Read a gradebook.

    Raises
    ------
    ValueError
        If it is not a gradebook of Canvas.
    """
    try:
        with path.open(encoding="utf-8", newline="") as file:
            text = file.read()
    except UnicodeDecodeError:
        raise ValueError(f"{path} is not text in UTF-8. {_AGAIN}") from None
    bom = "\ufeff" if text.startswith("\ufeff") else ""
    text = text.removeprefix("\ufeff")
    separator = ";" if text.startswith(f"{STUDENT};") else ","
    try:
        lines = [tuple(row) for row in csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)]
    except csv.Error as error:
        raise ValueError(f"{path} is not CSV ({error}). {_AGAIN}") from None
    columns = lines[0] if lines else ()
    missing = [name for name in (STUDENT, LOGIN) if name not in columns]
    if missing:
        raise ValueError(f"{path} is not a gradebook of Canvas: it has no column {missing[0]!r}. {_AGAIN}")
    if len(set(columns)) != len(columns):
        twice = next(name for name in columns if columns.count(name) > 1)
        raise ValueError(f"{path} has the column {twice!r} twice. Rename one of them in Canvas, and export it again.")
    rows = []
    for number, row in enumerate(lines[1:], start=2):
        if row and len(row) != len(columns):
            raise ValueError(f"{path} has {len(row)} fields in row {number}, but {len(columns)} columns. {_AGAIN}")
        rows += [row] if row else []
    who = [columns.index(name) for name in (USER, SIS_USER, LOGIN) if name in columns]
    above = tuple(row for row in rows if not any(row[place].strip() for place in who))
    students = tuple(row for row in rows if any(row[place].strip() for place in who))
    line_end = "\r\n" if "\r\n" in text else "\n"
    return CanvasGradebook(columns, above, students, separator, line_end, bom, path)


def is_gradebook(path: Path) -> bool:
    """Whether the first line of a file is that of a gradebook of Canvas."""
    try:
        with path.open(encoding="utf-8-sig", errors="replace") as file:
            return re.match(rf"\"?{STUDENT}\"?[,;]", file.readline(1000)) is not None
    except OSError:
        return False


def gradebook_text(book: CanvasGradebook, rows: Iterable[Sequence[str]]) -> str:
    """Text of the gradebook with other rows, in its own format; a name that is a formula gets an apostrophe."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, delimiter=book.separator, lineterminator=book.line_end)
    writer.writerow(book.columns)
    writer.writerows(book.above)
    place = book.columns.index(STUDENT)
    writer.writerows([*row[:place], as_text_cell(row[place]), *row[place + 1 :]] for row in rows)
    return book.bom + text.getvalue()


def name_of(column: str) -> str:
    """The name of the assignment in the heading of its column, without the number."""
    return _NUMBER.sub("", column).strip()


def find_students(book: CanvasGradebook, known: Iterable[Student]) -> dict[int, str]:
    """The ID of each row's student, by the number of the row, where it is known.

    A row is a student's if its login ID, its SIS user ID or, where neither is known, its ID in Canvas is the ID, the
    username or the e-mail address of that student.

    Raises
    ------
    ValueError
        If a row could be that of two students, or two rows that of one.
    """
    ids: dict[str, Student] = {}
    for student in known:
        for value in (student.id, student.username, student.email):
            if value and ids.setdefault(value.casefold(), student).id != student.id:
                raise ValueError(f"{value} is both {described(ids[value.casefold()])} and {described(student)}.")
    students: dict[int, str] = {}
    owners: dict[str, str] = {}
    for number, row in enumerate(book.rows):
        name = one_line(book.value(row, STUDENT)) or f"row {number + 1}"
        said = [ids.get(book.value(row, column).casefold()) for column in (LOGIN, SIS_USER)]
        people = {student.id: student for student in said if student is not None}
        if len(people) > 1:
            both = " and ".join(described(student) for student in people.values())
            raise ValueError(f"{book.path}: the row of {name} belongs to two students by its IDs, {both}.")
        if not people and (by_number := ids.get(book.value(row, USER).casefold())) is not None:
            people = {by_number.id: by_number}
        for student_id in people:
            if student_id in owners:
                raise ValueError(
                    f"{book.path}: the rows of {owners[student_id]} and {name} both belong to {student_id}."
                )
            owners[student_id] = name
            students[number] = student_id
    return students


def as_worksheet(book: CanvasGradebook, known: Iterable[Student] = ()) -> Worksheet:
    """Who is who, with the number that Canvas gives each user and puts into the names of downloaded files.

    The test student of Canvas is nobody of the class, and not in it.

    The ID is the login ID, or the SIS user ID if that is the ID of more of the known students.
    """
    ids = {student.id.casefold() for student in known}
    counts = {name: sum(book.value(row, name).casefold() in ids for row in book.rows) for name in (LOGIN, SIS_USER)}
    id_column = SIS_USER if counts[SIS_USER] > counts[LOGIN] else LOGIN
    rows = []
    for row in (one for one in book.rows if not book.is_test_student(one)):
        login, (last, comma, first) = book.value(row, LOGIN), one_line(book.value(row, STUDENT)).partition(",")
        values = (f"Participant {book.value(row, USER)}", f"{first.strip()} {last.strip()}" if comma else last.strip())
        email = login if "@" in login else ""
        rows.append(dict(zip(_COLUMNS, (*values, email, book.value(row, id_column), login), strict=True)))
    return Worksheet(_COLUMNS, tuple(rows), "", book.path)
