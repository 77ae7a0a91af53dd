"""Moodle's offline grading worksheet: read, matched to students, and written back with the grades in it."""

import csv
import io
import re
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

IDENTIFIER, FULL_NAME, EMAIL = "Identifier", "Full name", "Email address"
GRADE, MAXIMUM, CHANGEABLE = "Grade", "Maximum Grade", "Grade can be changed"
FEEDBACK, SUBMITTED = "Feedback comments", "Last modified (submission)"
ID_COLUMNS = ("ID number", "Username", EMAIL)
"""Where a student's ID is taken from: the first of these that is there and filled in, else the number."""

_TIMES = ("%A, %d %B %Y, %I:%M %p", "%A, %d %B %Y, %H:%M", "%d %B %Y, %I:%M %p", "%d %B %Y, %H:%M", "%Y-%m-%d %H:%M:%S")


@dataclass(frozen=True, slots=True)
class Worksheet:
    """A worksheet as it came.

    Attributes
    ----------
    columns : tuple of str
    rows : tuple of dict
        By column.
    start : str
        A byte order mark, where there was one.
    """

    columns: tuple[str, ...]
    rows: tuple[dict[str, str], ...]
    start: str


def read_worksheet(path: Path) -> Worksheet:
    """Read a worksheet.

    Raises
    ------
    ValueError
        If it is none: the column Identifier, with such as ``Participant 123456``, must be there.
    """
    try:
        text = path.read_text(encoding="utf-8")
        start = "\ufeff" if text.startswith("\ufeff") else ""
        rows = list(csv.reader(io.StringIO(text.removeprefix("\ufeff"), newline=""), strict=True))
    except UnicodeDecodeError:
        raise ValueError(f"{path} is not text in UTF-8. Download the worksheet again, as CSV.") from None
    except csv.Error as error:
        raise ValueError(f"{path} is not CSV ({error}). Download the worksheet again.") from None
    if not rows or IDENTIFIER not in rows[0]:
        raise ValueError(
            f"{path} is not a grading worksheet: it has no column {IDENTIFIER}. In Moodle, switch on "
            "'Offline grading worksheet' and download it, in English."
        )
    columns = rows[0]
    if len(set(columns)) != len(columns):
        raise ValueError(f"{path} has two columns of one name. Download the worksheet again.")
    for number, row in enumerate(rows[1:], start=2):
        if row and len(row) != len(columns):
            raise ValueError(f"{path} has {len(row)} fields in row {number}, and {len(columns)} columns.")
    return Worksheet(tuple(columns), tuple(dict(zip(columns, row, strict=True)) for row in rows[1:] if row), start)


def worksheet_text(sheet: Worksheet, rows: Sequence[dict[str, str]]) -> str:
    """The worksheet with other rows, in its own columns and order."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, sheet.columns, lineterminator="\r\n")
    writer.writeheader()
    writer.writerows(rows)
    return sheet.start + text.getvalue()


def participant_number(row: Mapping[str, str]) -> str | None:
    """The participant number of a row, from such as ``Participant 123456``; None where there is none."""
    found = re.search(r"(\d{1,18})\s*$", row.get(IDENTIFIER, ""), re.ASCII)
    return (found[1].lstrip("0") or "0") if found else None


def possible_ids(row: Mapping[str, str]) -> Iterator[str]:
    """What a row's student may be called in the course, the first choice first."""
    for column in ID_COLUMNS:
        name = folder_name(row.get(column, ""))
        if name is not None:
            yield name
    number = participant_number(row)
    if number is not None:
        yield number


def folder_name(student: str) -> str | None:
    """A student's ID as the name of a folder anywhere; None where it cannot be one."""
    name = unicodedata.normalize("NFC", student.strip())
    if not re.fullmatch(r"[\w@+-][\w.@+ -]{0,99}", name) or name.endswith((".", " ")):
        return None
    return None if re.fullmatch(r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\..*)?", name) else name


def submission_time(row: Mapping[str, str]) -> datetime | None:
    """When a row's student handed in, in Moodle's own zone and without its name; None where it cannot be read."""
    text = " ".join(row.get(SUBMITTED, "").split())
    for form in _TIMES:
        try:
            return datetime.strptime(text, form)
        except ValueError:
            continue
    return None


def utc_timestamp(when: datetime) -> str:
    """As nbgrader writes it into ``timestamp.txt``."""
    return when.astimezone(UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
