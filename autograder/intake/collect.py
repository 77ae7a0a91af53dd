"""Extract submissions from the zip file of Moodle's "Download all submissions".

Moodle makes a folder ``Full Name_123456_assignsubmission_file_`` for each student or, with folders disabled, files with
this prefix; 123456 is the participant number. The grading worksheet of the same assignment maps this number to the
student's ID: its ``ID number``, otherwise ``Username``, otherwise ``Email address``. Without a worksheet, or if
these are empty, the participant number is the ID.

File names in the zip are never used as output paths: these consist of a validated ID and the name of an assignment.
"""

import io
import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime, tzinfo
from functools import cache, partial
from pathlib import Path
from typing import IO, Any

from autograder.course.archive import ArchiveEntry, read_entries
from autograder.course.layout import Course, read_template
from autograder.course.plain_text import one_line
from autograder.course.students import Student, merge_students, read_students, write_students
from autograder.intake.submission import is_untouched
from autograder.intake.untrusted_json import read_json
from autograder.intake.worksheet import (
    EMAIL,
    Worksheet,
    participant_number,
    possible_ids,
    submission_time,
    utc_timestamp,
)
from labsid._files import write_file
from labsid.checks.cells import Template
from labsid.checks.notebook import find_assignment

_MARKER = r"_(?P<number>\d{1,18})_assignsubmission_[a-z]+_?"
_FOLDER = re.compile(rf"(?P<name>[^/]*){_MARKER}(?P<rest>)", re.ASCII)
_FILE = re.compile(rf"(?P<name>[^/]*?){_MARKER}(?P<rest>[^/]+)", re.ASCII)
_ONE_MARKER = re.compile(r"_\d{1,18}_assignsubmission_", re.ASCII)
STUDENTS_FILE = "students.csv"
"""Names and e-mail addresses of the participants, in the folder of their submissions."""

MAX_PARTICIPANT_BYTES = 200 * 1024 * 1024


@dataclass(frozen=True, slots=True)
class _ParticipantFiles:
    """The files of one participant."""

    name: str
    number: str
    notebooks: dict[str, list[ArchiveEntry]] = field(default_factory=dict)
    data: dict[str, ArchiveEntry] = field(default_factory=dict)
    skipped: list[str] = field(default_factory=list)


def collect_submissions(
    course: Course,
    path: Path,
    out: Path,
    sheet: Worksheet | None = None,
    zone: tzinfo | None = None,
    assignments: Sequence[str] = (),
) -> Iterator[str]:
    """Extract submissions from Moodle's zip file.

    Parameters
    ----------
    course : Course
        Built; the assignment of a notebook is recognised by its cells.
    path : Path
        The zip file.
    out : Path
        Receives ``<student>/<assignment>/<assignment>.ipynb``, the submitted data file, and ``timestamp.txt`` if the
        worksheet has the time; also `STUDENTS_FILE`. Existing files are replaced if the zip contains a new version.
        Notebooks as they were released are not written.
    sheet : Worksheet, optional
        Grading worksheet of the same assignment.
    zone : tzinfo, optional
        Time zone of the worksheet; default this machine's.
    assignments : sequence of str, optional
        The assignments to collect; default all.

    Yields
    ------
    str
        A line for each student, and one for files of no participant.

    Raises
    ------
    ValueError
        If it is not a zip file, or not from Moodle, or there is no such assignment.
    """
    wanted = course.select(assignments)
    if out.exists() and not out.is_dir():
        raise ValueError(f"{out} is a file; give --out another name.")
    templates = {name: read_template(course, name) for name in course.assignments()}
    with path.open("rb") as content:
        participants, strays = _read_participants(content, path.name, templates)
    if not participants:
        raise ValueError(
            f"{path} contains no submission: expected folders such as 'Full Name_123456_assignsubmission_file_', "
            "as Moodle's 'Download all submissions' makes them."
        )
    rows = {} if sheet is None else _rows_by_number(sheet)
    used_ids: set[str] = set()
    students: list[Student] = []
    for participant in sorted(participants.values(), key=lambda one: (one.name, int(one.number))):
        row = rows.get(participant.number)
        student = participant.number if row is None else next(possible_ids(row), participant.number)
        unknown = sheet is not None and row is None
        duplicate = student.casefold() in used_ids
        if duplicate:
            student = next(one for one in _own_ids(participant) if one.casefold() not in used_ids)
        used_ids.add(student.casefold())
        address = "" if row is None else row.get(EMAIL, "")
        students.append(Student(student, one_line(participant.name), one_line(address)))
        submitted = None if row is None else submission_time(row)
        timestamp = None if submitted is None else utc_timestamp(submitted.replace(tzinfo=zone))
        remarks = _write_submission(out / student, participant, templates, wanted, timestamp)
        remarks += ["not in the worksheet: the participant number is the ID"] if unknown else []
        remarks += (
            [f"another participant has the same ID: {_described(student, participant)} is the ID"] if duplicate else []
        )
        yield one_line(f"{student} ({participant.name}): {'; '.join(remarks)}")
    path = out / STUDENTS_FILE
    write_students(path, merge_students(read_students(path) if path.is_file() else [], students))
    if strays:
        yield one_line(f"files of no participant: {', '.join(strays[:10])}{' ...' if len(strays) > 10 else ''}")


def _own_ids(participant: _ParticipantFiles) -> Iterator[str]:
    """IDs of a participant whose own ID is taken; another one's ID may be this participant's number."""
    yield participant.number
    yield from (f"participant-{participant.number}-{n}" for n in itertools.count(1))


def _described(student: str, participant: _ParticipantFiles) -> str:
    return "the participant number" if student == participant.number else student


def _rows_by_number(sheet: Worksheet) -> dict[str, dict[str, str]]:
    """The rows of a worksheet by participant number; `ValueError` if two rows have the same number."""
    rows: dict[str, dict[str, str]] = {}
    for row in sheet.rows:
        number = participant_number(row)
        if number is None:
            continue
        if number in rows:
            raise ValueError(f"the worksheet has participant {number} twice. Download it again.")
        rows[number] = row
    return rows


def _read_participants(
    content: IO[bytes], what: str, templates: Mapping[str, Template]
) -> tuple[dict[str, _ParticipantFiles], list[str]]:
    participants: dict[str, _ParticipantFiles] = {}
    strays: list[str] = []
    remaining: dict[str, int] = {}  # bytes, by participant number

    def remaining_for(number: str, _: str) -> int:
        """Remaining bytes of a participant; a zip bomb must not affect other participants."""
        return remaining.get(number, MAX_PARTICIPANT_BYTES)

    def max_bytes(path: str) -> int:
        owner, _ = _match_owner(path)
        return 0 if owner is None else remaining_for(_participant_number(owner), path)

    for entry in read_entries(content, what, max_bytes):
        owner, name = _match_owner(entry.name)
        if owner is None:
            strays.append(name)
            continue
        number = _participant_number(owner)
        participant = participants.setdefault(number, _ParticipantFiles(owner["name"], number))
        remaining[number] = remaining_for(number, name) - len(entry.data)
        if name.lower().endswith(".zip") and not entry.problem:
            try:
                for inner in read_entries(io.BytesIO(entry.data), name, partial(remaining_for, number)):
                    remaining[number] -= len(inner.data)
                    # the times in an inner zip are those of the packing program
                    _add_file(
                        participant,
                        ArchiveEntry(f"{name}/{inner.name}", entry.modified, inner.data, inner.problem),
                        templates,
                    )
            except ValueError as error:
                participant.skipped.append(str(error).rstrip("."))
        else:
            _add_file(participant, ArchiveEntry(name, entry.modified, entry.data, entry.problem), templates)
    return participants, strays


def _participant_number(owner: re.Match[str]) -> str:
    return owner["number"].lstrip("0") or "0"


def _match_owner(path: str) -> tuple[re.Match[str] | None, str]:
    """Match the participant in a path, a folder at any depth or a file prefix; also returns the path below it.

    Students choose their names and those of their files, so that these may contain the marker of another participant.
    In the name of a folder, which ends with it, the last marker is Moodle's; a file with several has no known owner.
    """
    parts = [part for part in path.split("/") if part not in ("", ".")]
    for index, part in enumerate(parts[:-1]):
        found = _FOLDER.fullmatch(part)
        if found is not None:
            return found, "/".join(parts[index + 1 :])
    found = _FILE.fullmatch(parts[-1]) if parts and len(_ONE_MARKER.findall(parts[-1])) == 1 else None
    return found, path if found is None else found["rest"]


def _add_file(participant: _ParticipantFiles, entry: ArchiveEntry, templates: Mapping[str, Template]) -> None:
    """Add a file to its participant: a notebook of an assignment, a data file, or skipped."""
    base = entry.name.rpartition("/")[2]
    if "__MACOSX" in entry.name or base.startswith(".") or ".ipynb_checkpoints" in entry.name:
        return
    if entry.problem:
        participant.skipped.append(f"{entry.name}: {entry.problem}")
    elif base.lower().endswith(".ipynb"):
        name = _assignment_of(entry, templates)
        if name is None:
            participant.skipped.append(f"{entry.name}: not a notebook of this course")
        else:
            participant.notebooks.setdefault(name, []).append(entry)
    else:
        data = _data_files(tuple(templates))
        if base in data and (
            base not in participant.data or _version_key(entry) >= _version_key(participant.data[base])
        ):
            participant.data[base] = entry
        elif base not in data:
            participant.skipped.append(entry.name)


@cache
def _data_files(assignments: tuple[str, ...]) -> frozenset[str | None]:
    return frozenset(find_assignment(name).record_file for name in assignments)


def _assignment_of(entry: ArchiveEntry, templates: Mapping[str, Template]) -> str | None:
    """The assignment whose cells a notebook contains; if it cannot be read, the one that its path names."""
    try:
        ids = {_grade_id(cell) for cell in read_json(entry.data)["cells"]}
    except (ValueError, KeyError, TypeError, RecursionError):
        ids = set()
    shared = {name: len(ids & {cell.id for cell in template.cells}) for name, template in templates.items()}
    largest = max(shared.values(), default=0)
    if largest:
        return next(name for name, count in shared.items() if count == largest)
    named = [name for name in templates if name in entry.name.lower()]
    return max(named, key=len) if named else None


def _grade_id(cell: Any) -> str | None:
    try:
        return str(cell["metadata"]["nbgrader"]["grade_id"])
    except (KeyError, TypeError, IndexError):
        return None


def _version_key(entry: ArchiveEntry) -> tuple[datetime, int, str]:
    """Sort key of versions, latest last; ``lab (2).ipynb`` is later than ``lab.ipynb`` of the same time."""
    copy = re.search(r"\((\d{1,6})\)\.\w+$", entry.name)
    return entry.modified or datetime.min, int(copy[1]) if copy else 0, entry.name


def _write_submission(
    folder: Path,
    participant: _ParticipantFiles,
    templates: Mapping[str, Template],
    wanted: Sequence[str],
    timestamp: str | None,
) -> list[str]:
    """Write what a participant handed in; a participant without a notebook gets an empty folder, and is graded, too."""
    written: list[str] = []
    untouched: list[str] = []
    others: list[str] = []
    folder.mkdir(parents=True, exist_ok=True)
    for name, found in sorted(participant.notebooks.items()):
        versions = [version for version in found if not is_untouched(version.data, templates[name])]
        if not versions or name not in wanted:
            (others if versions else untouched).append(name)
            continue
        latest = max(versions, key=_version_key)
        files = {f"{name}.ipynb": latest.data}
        data = find_assignment(name).record_file
        if data is not None and data in participant.data:
            files[data] = participant.data[data].data
        if timestamp is not None:
            files["timestamp.txt"] = f"{timestamp}\n".encode()
        replaced = [
            _write_below(folder.parent, Path(folder.name, name, file), content) for file, content in files.items()
        ]
        notes = [f"the latest of {len(versions)} versions: {latest.name}"] if len(versions) > 1 else []
        notes += ["replaces what was collected before"] if any(replaced) else []
        written.append(f"{name} ({', '.join(notes)})" if notes else name)
    remarks = [", ".join(written)] if written else []
    if untouched:
        remarks.append(f"as released, not collected: {', '.join(untouched)}")
    if others:
        remarks.append(f"other assignments, not collected: {', '.join(others)}")
    if not participant.notebooks:
        remarks.append("no notebook of this course")
    if participant.skipped:
        remarks.append(f"skipped: {', '.join(participant.skipped[:5])}{' ...' if len(participant.skipped) > 5 else ''}")
    return remarks


def _write_below(out: Path, inner: Path, content: bytes) -> bool:
    """Write a file below OUT unless it exists with the same content; returns whether it replaced another content."""
    path = out / inner
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.parent.resolve() != out.resolve() / inner.parent or path.is_symlink():
        raise ValueError(f"{path} is a symbolic link, or is below one; collect into another folder.")
    exists = path.is_file()
    if exists and path.read_bytes() == content:
        return False
    write_file(path, content)
    return exists
