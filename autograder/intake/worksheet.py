"""Moodle's offline grading worksheet: read it, match its rows to students, and format it."""

import csv
import io
import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

IDENTIFIER, FULL_NAME, EMAIL = "Identifier", "Full name", "Email address"
GRADE, MAXIMUM, CHANGEABLE = "Grade", "Maximum Grade", "Grade can be changed"
FEEDBACK, SUBMITTED = "Feedback comments", "Last modified (submission)"
USERNAME = "Username"
ID_COLUMNS = ("ID number", USERNAME, EMAIL)
"""Columns with the student ID, in order of preference; the participant number is used if all are empty."""

_TIMES = ("%A, %d %B %Y, %I:%M %p", "%A, %d %B %Y, %H:%M", "%d %B %Y, %I:%M %p", "%d %B %Y, %H:%M", "%Y-%m-%d %H:%M:%S")


@dataclass(frozen=True, slots=True)
class Worksheet:
    """A worksheet as downloaded.

    Attributes
    ----------
    columns : tuple of str
    rows : tuple of dict
        Values by column.
    bom : str
        The byte order mark, if any.
    path : Path
        The file, for messages.
    """

    columns: tuple[str, ...]
    rows: tuple[dict[str, str], ...]
    bom: str
    path: Path = Path("WORKSHEET.csv")


def read_worksheet(path: Path) -> Worksheet:
    """Read a worksheet.

    Raises
    ------
    ValueError
        If it is not a worksheet, which has a column Identifier with values such as ``Participant 123456``.
    """
    try:
        text = path.read_text(encoding="utf-8")
        bom = "\ufeff" if text.startswith("\ufeff") else ""
        rows = list(csv.reader(io.StringIO(text.removeprefix("\ufeff"), newline=""), strict=True))
    except UnicodeDecodeError:
        raise ValueError(f"{path} is not text in UTF-8. Download the worksheet again, as CSV.") from None
    except csv.Error as error:
        raise ValueError(f"{path} is not CSV ({error}). Download the worksheet again.") from None
    if not rows or IDENTIFIER not in rows[0]:
        raise ValueError(
            f"{path} is not a grading worksheet: it has no column {IDENTIFIER}. In Moodle, enable "
            "'Offline grading worksheet' and download it in English."
        )
    columns = rows[0]
    if len(set(columns)) != len(columns):
        raise ValueError(f"{path} has two columns with the same name. Download the worksheet again.")
    for number, row in enumerate(rows[1:], start=2):
        if row and len(row) != len(columns):
            raise ValueError(f"{path} has {len(row)} fields in row {number}, but {len(columns)} columns.")
    return Worksheet(tuple(columns), tuple(dict(zip(columns, row, strict=True)) for row in rows[1:] if row), bom, path)


def worksheet_text(sheet: Worksheet, rows: Sequence[dict[str, str]]) -> str:
    """Text of the worksheet with other rows, in its own format."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, sheet.columns, lineterminator="\r\n")
    writer.writeheader()
    writer.writerows(rows)
    return sheet.bom + text.getvalue()


def participant_number(row: Mapping[str, str]) -> str | None:
    """The participant number of a row, from a value such as ``Participant 123456``; None if there is none."""
    found = re.search(r"(\d{1,18})\s*$", row.get(IDENTIFIER, ""), re.ASCII)
    return (found[1].lstrip("0") or "0") if found else None


def participant_folder(row: Mapping[str, str]) -> str:
    """The folder of a row's participant in a zip file for Moodle.

    Moodle splits the name at underscores, so that a student's name must not contain any.
    """
    name = re.sub(r"[\x00-\x1f/\\:*?\"<>|]", "", row.get(FULL_NAME, "")).replace("_", " ").strip(". ")
    return f"{name or 'Participant'}_{participant_number(row)}_assignsubmission_file_"


def folder_name(student: str) -> str | None:
    """A student ID as a folder name that is valid on every system; None if it cannot be one."""
    name = unicodedata.normalize("NFC", student.strip())
    if not re.fullmatch(r"[\w@+-][\w.@+ -]{0,99}", name) or name.endswith((".", " ")):
        return None
    return None if re.fullmatch(r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\..*)?", name) else name


def submission_time(row: Mapping[str, str]) -> datetime | None:
    """Submission time of a row, in Moodle's time zone but without tzinfo; None if it cannot be parsed."""
    text = " ".join(row.get(SUBMITTED, "").split())
    for form in _TIMES:
        try:
            return datetime.strptime(text, form)
        except ValueError:
            continue
    return None


def utc_timestamp(when: datetime) -> str:
    """Format a time as in nbgrader's ``timestamp.txt``."""
    return when.astimezone(UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
