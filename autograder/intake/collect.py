"""Hand-ins as Moodle's "Download all submissions" zips them, into the layout that is graded.

Moodle makes a folder ``Full Name_123456_assignsubmission_file_`` for each student, or, with folders switched off, files
whose names begin so; 123456 is the participant number of this assignment in Moodle. With the grading worksheet of the
same assignment the number becomes the student's ID: what the worksheet has under ``ID number``, else ``Username``, else
``Email address``. Without it, or where the worksheet has none of these, the participant number is the ID.

Names in the zip are only read. Every path that is written is made here, of a checked ID and the name of an assignment.
"""

import io
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime, tzinfo
from functools import partial
from pathlib import Path
from typing import IO, Any

from autograder.course.archive import ArchiveEntry, read_entries
from autograder.course.layout import Course, Template, read_template
from autograder.course.plain_text import one_line
from autograder.intake.untrusted_json import read_json
from autograder.intake.worksheet import Worksheet, participant_number, possible_ids, submission_time, utc_timestamp
from labsid._files import write_file
from labsid.checks.notebook import load_assignment

_MOODLE_FOLDER = re.compile(r"(?P<name>[^/]*?)_(?P<number>\d{1,18})_assignsubmission_[a-z]+_?(?P<rest>.*)", re.ASCII)
MAX_PARTICIPANT_BYTES = 200 * 1024 * 1024


@dataclass(frozen=True, slots=True)
class _ParticipantFiles:
    """All that one participant handed in, while the zip is read."""

    name: str
    number: str
    notebooks: dict[str, list[ArchiveEntry]] = field(default_factory=dict)
    data: dict[str, ArchiveEntry] = field(default_factory=dict)
    left_out: list[str] = field(default_factory=list)


def collect_submissions(
    course: Course, path: Path, out: Path, sheet: Worksheet | None = None, zone: tzinfo | None = None
) -> Iterator[str]:
    """Take the hand-ins out of Moodle's zip.

    Parameters
    ----------
    course : Course
        Built: which notebook it is, is seen from the cells in it.
    path : Path
        The zip.
    out : Path
        Gets ``<student>/<assignment>/<assignment>.ipynb``, the data file where one was handed in, and
        ``timestamp.txt`` where the worksheet has the time. What is there already is replaced by what is in the zip,
        and left where the zip has nothing.
    sheet : Worksheet, optional
        Of the same assignment in Moodle.
    zone : tzinfo, optional
        The zone of the worksheet's times; unless given, this machine's.

    Yields
    ------
    str
        A line for each student, and one for what belongs to nobody.

    Raises
    ------
    ValueError
        If it is not a zip, or nothing in it is Moodle's.
    """
    if out.exists() and not out.is_dir():
        raise ValueError(f"{out} is a file; give --out another name.")
    templates = {name: read_template(course, name) for name in course.assignments()}
    with path.open("rb") as content:
        hand_ins, strays = _read_participants(content, path.name, templates)
    if not hand_ins:
        raise ValueError(
            f"{path} holds no submission: expected folders such as 'Full Name_123456_assignsubmission_file_', "
            "as Moodle's 'Download all submissions' makes them."
        )
    rows = {} if sheet is None else {participant_number(row): row for row in sheet.rows}
    taken: dict[str, str] = {}
    for hand_in in sorted(hand_ins.values(), key=lambda one: (one.name, int(one.number))):
        row = rows.get(hand_in.number)
        student = hand_in.number if row is None else next(possible_ids(row), hand_in.number)
        unknown = sheet is not None and row is None
        twice = student.casefold() in taken
        if twice:
            student = hand_in.number
        taken[student.casefold()] = hand_in.number
        said = _write_submission(out / student, hand_in, None if row is None else submission_time(row), zone)
        said += ["not in the worksheet: the participant number is the ID"] if unknown else []
        said += ["another participant has the same ID: the participant number is the ID"] if twice else []
        yield one_line(f"{student} ({hand_in.name}): {'; '.join(said)}")
    if strays:
        yield one_line(f"belongs to nobody: {', '.join(strays[:10])}{' ...' if len(strays) > 10 else ''}")


def _read_participants(
    content: IO[bytes], what: str, templates: Mapping[str, Template]
) -> tuple[dict[str, _ParticipantFiles], list[str]]:
    hand_ins: dict[str, _ParticipantFiles] = {}
    strays: list[str] = []
    left: dict[str, int] = {}

    def allowed(path: str) -> int:
        """What a participant may still have unpacked: a bomb costs nobody else their hand-in."""
        owner, _ = _match_owner(path)
        return 0 if owner is None else left.get(_participant_number(owner), MAX_PARTICIPANT_BYTES)

    for entry in read_entries(content, what, allowed):
        owner, name = _match_owner(entry.name)
        if owner is None:
            strays.append(name)
            continue
        number = _participant_number(owner)
        hand_in = hand_ins.setdefault(number, _ParticipantFiles(owner["name"], number))
        left[number] = left.get(number, MAX_PARTICIPANT_BYTES) - len(entry.data)
        if name.lower().endswith(".zip") and not entry.refused:
            try:
                for inner in read_entries(io.BytesIO(entry.data), name, partial(_left_for, left, number)):
                    left[number] -= len(inner.data)
                    # the time of the zip counts: the times in it are the packing program's
                    _add_file(
                        hand_in,
                        ArchiveEntry(f"{name}/{inner.name}", entry.changed, inner.data, inner.refused),
                        templates,
                    )
            except ValueError as error:
                hand_in.left_out.append(str(error).rstrip("."))
        else:
            _add_file(hand_in, ArchiveEntry(name, entry.changed, entry.data, entry.refused), templates)
    return hand_ins, strays


def _left_for(left: Mapping[str, int], number: str, path: str) -> int:
    return left[number]


def _participant_number(owner: re.Match[str]) -> str:
    return owner["number"].lstrip("0") or "0"


def _match_owner(path: str) -> tuple[re.Match[str] | None, str]:
    """Whose a path is, and what it is called there: the folder may stand below others, or be the start of a name."""
    parts = [part for part in path.split("/") if part not in ("", ".")]
    for index, part in enumerate(parts):
        found = _MOODLE_FOLDER.fullmatch(part)
        if found is not None:
            return found, "/".join([*([found["rest"]] if found["rest"] else []), *parts[index + 1 :]])
    return None, path


def _add_file(hand_in: _ParticipantFiles, entry: ArchiveEntry, templates: Mapping[str, Template]) -> None:
    """Put a file where it belongs: a notebook of an assignment, a data file, or left out."""
    base = entry.name.rpartition("/")[2]
    if "__MACOSX" in entry.name or base.startswith(".") or ".ipynb_checkpoints" in entry.name:
        return
    if entry.refused:
        hand_in.left_out.append(f"{entry.name}: {entry.refused}")
    elif base.lower().endswith(".ipynb"):
        name = _assignment_of(entry, templates)
        if name is None:
            hand_in.left_out.append(f"{entry.name}: a notebook of no assignment of this course")
        else:
            hand_in.notebooks.setdefault(name, []).append(entry)
    else:
        data = {load_assignment(name).record_file for name in templates}
        if base in data and (base not in hand_in.data or _version_key(entry) >= _version_key(hand_in.data[base])):
            hand_in.data[base] = entry
        elif base not in data:
            hand_in.left_out.append(entry.name)


def _assignment_of(entry: ArchiveEntry, templates: Mapping[str, Template]) -> str | None:
    """The assignment whose cells a notebook has; where it cannot be read, the one that its path names."""
    try:
        ids = {_grade_id(cell) for cell in read_json(entry.data)["cells"]}
    except (ValueError, KeyError, TypeError, RecursionError):
        ids = set()
    shared = {name: len(ids & {cell.id for cell in template.cells}) for name, template in templates.items()}
    most = max(shared.values(), default=0)
    if most:
        return next(name for name, count in shared.items() if count == most)
    named = [name for name in templates if name in entry.name.lower()]
    return max(named, key=len) if named else None


def _grade_id(cell: Any) -> str | None:
    try:
        return str(cell["metadata"]["nbgrader"]["grade_id"])
    except (KeyError, TypeError, IndexError):
        return None


def _version_key(entry: ArchiveEntry) -> tuple[datetime, int, str]:
    """Sorts versions of a file, the latest last; ``lab (2).ipynb`` is later than ``lab.ipynb`` of the same time."""
    copy = re.search(r"\((\d{1,6})\)\.\w+$", entry.name)
    return entry.changed or datetime.min, int(copy[1]) if copy else 0, entry.name


def _write_submission(
    folder: Path, hand_in: _ParticipantFiles, submitted: datetime | None, zone: tzinfo | None
) -> list[str]:
    said: list[str] = []
    for name, versions in sorted(hand_in.notebooks.items()):
        latest = max(versions, key=_version_key)
        files = {f"{name}.ipynb": latest.data}
        data = load_assignment(name).record_file
        if data is not None and data in hand_in.data:
            files[data] = hand_in.data[data].data
        if submitted is not None:
            files["timestamp.txt"] = (utc_timestamp(submitted.replace(tzinfo=zone)) + "\n").encode()
        for file, content in files.items():
            _write_below(folder.parent, Path(folder.name, name, file), content)
        said.append(name if len(versions) == 1 else f"{name} (the latest of {len(versions)} versions: {latest.name})")
    said = [", ".join(said) or "no notebook of this course"]
    if hand_in.left_out:
        said.append(f"left out: {', '.join(hand_in.left_out[:5])}{' ...' if len(hand_in.left_out) > 5 else ''}")
    return said


def _write_below(out: Path, inner: Path, content: bytes) -> None:
    """Write a file below OUT, unless it is there as it should be: running again touches nothing."""
    path = out / inner
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.parent.resolve() != out.resolve() / inner.parent or path.is_symlink():
        raise ValueError(f"{path} is a link, or lies below one; collect into a folder of its own.")
    if not (path.is_file() and path.read_bytes() == content):
        write_file(path, content)
