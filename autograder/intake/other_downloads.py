"""The downloads of Canvas and Gradescope: whose is which file, and when it was handed in.

Canvas makes one folder of files ``lastnamefirst_LATE_12345_67890_name.ipynb``: the name, whether it was late, the
number of the user, that of the file, and its name. Gradescope's "Export Submissions" has a folder ``submission_12345``
for each submission, and a table ``submission_metadata.yml`` that names who handed it in, and when. Students choose the
names of their files, and their own.
"""

import re
import zipfile
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime

import yaml

from autograder.course.archive import Budget, Pool, entry_name, read_entries
from autograder.course.plain_text import one_line
from autograder.intake.download import Participant, is_of_moodle
from autograder.intake.worksheet import EMAIL, FULL_NAME, ID_COLUMNS, IDENTIFIER, utc_timestamp

SYSTEMS = ("moodle", "canvas", "gradescope")

METADATA = "submission_metadata.yml"
_METADATA_WORK = 100_000_000
_MAX_EVENTS = 3_000_000
_DEEPEST = 32  # levels of a table of Gradescope: it has five
_SUBMISSION = re.compile(r"submission_(\d{1,18})", re.ASCII)
_FIRST_NUMBER = 10**17
"""Gradescope has no number of a person; these are none that another system gives."""

_CANVAS = re.compile(r"(?=_(?P<user>\d{1,18})_(?P<file>\d{1,18})_(?P<rest>[^/]+)$)", re.ASCII)
_ATTEMPT = re.compile(r"(?P<stem>.+?)(?:-(?P<number>\d{1,3}))?(?P<ending>\.\w+)", re.ASCII)
_LATE = "_LATE"
_COLUMNS = {"name": FULL_NAME, "email": EMAIL, "sid": ID_COLUMNS[0]}
_TIME = re.compile(r"(\d{4}-\d\d-\d\d)[ T](\d\d:\d\d:\d\d)(?:\.\d{1,9})? ?(Z|UTC|[+-]\d\d:?\d\d)", re.ASCII)


@dataclass(slots=True)
class Download:
    """What a download says before any file of a student is read.

    Attributes
    ----------
    participants : dict
        By the number of the participant, user or person.
    strays : list of str
        Files of no participant.
    times : dict
        When something was handed in, as in ``timestamp.txt``, by number, where the download says so.
    late : set of str
        Numbers of those whom the download calls late without a time.
    remarks : dict
        What to say about a participant, by number.
    rows : list of dict
        Who they are, as rows of a worksheet, where the download says so.
    """

    participants: dict[str, Participant] = field(default_factory=dict)
    strays: list[str] = field(default_factory=list)
    times: dict[str, str] = field(default_factory=dict)
    late: set[str] = field(default_factory=set)
    remarks: dict[str, list[str]] = field(default_factory=dict)
    rows: list[dict[str, str]] = field(default_factory=list)


def which_system(archive: zipfile.ZipFile) -> str:
    """The system that made a download: the one whose names most files have; no single file can decide it."""
    if _metadata_entry(archive) is not None:
        return "gradescope"
    names = [name for info in archive.infolist() if not (name := entry_name(info)).endswith("/")]
    counts = Counter("moodle" if is_of_moodle(name) else "canvas" for name in names if _is_known(name))
    return "canvas" if counts["canvas"] > counts["moodle"] else "moodle"


def _is_known(name: str) -> bool:
    return is_of_moodle(name) or any(_readings(name.rpartition("/")[2]))


def list_canvas(archive: zipfile.ZipFile, users: Collection[str] = ()) -> Download:
    """The participants of a download from Canvas.

    A name can be read in two ways where the student's name or that of the file has numbers, too. Then it is that of the
    one user who is known, and a file of nobody if there are several or none.

    Parameters
    ----------
    archive : ZipFile
    users : collection of str
        The numbers of the users in the gradebook, if there is one.
    """
    download = Download()
    for info in archive.infolist():
        path = entry_name(info)
        if path.endswith("/"):
            continue
        base = path.rpartition("/")[2]
        readings = list(_readings(base))
        if len(readings) > 1:
            readings = [reading for reading in readings if reading[1] in users]
        if len(readings) != 1:
            download.strays.append(path)
            continue
        name, user, rest = readings[0]
        is_late = name.endswith(_LATE)
        person = download.participants.setdefault(user, Participant(name.removesuffix(_LATE), user))
        person.entries.append((info, rest))
        if is_late:
            download.late.add(user)
            download.remarks[user] = ["late in Canvas, whose download has no times: no penalty is taken off"]
    for person in download.participants.values():
        _name_attempts(person.entries)
    return download


def _name_attempts(entries: list[tuple[zipfile.ZipInfo, str]]) -> None:
    """Put files of one name into a folder for each attempt: Canvas adds -1 to the name in the second, and so on."""
    parts = [_ATTEMPT.fullmatch(name) for _, name in entries]
    names = ["".join(part.group("stem", "ending")) if part is not None else "" for part in parts]
    counts = Counter(names)
    for place, (part, name) in enumerate(zip(parts, names, strict=True)):
        if part is not None and counts[name] > 1:
            entries[place] = entries[place][0], f"attempt {int(part['number'] or 0) + 1}/{name}"


def _readings(base: str) -> Iterator[tuple[str, str, str]]:
    """The ways to read the name of a file of Canvas: what stands before the numbers, the user, and the file's name."""
    for match in _CANVAS.finditer(base):
        if match.start() > 0:
            yield base[: match.start()], match["user"].lstrip("0") or "0", match["rest"]


def list_gradescope(archive: zipfile.ZipFile) -> Download:
    """The participants of an export of Gradescope; each who handed in a submission together has all of its files.

    Raises
    ------
    ValueError
        If the table of the submissions is missing or cannot be read.
    """
    table = _metadata_entry(archive)
    if table is None:
        raise ValueError(f"there is no {METADATA} in it. In Gradescope, use Export Submissions.")
    (entry,) = read_entries(archive, [table], Budget(_METADATA_WORK, _METADATA_WORK, Pool(0)))
    if entry.problem:
        raise ValueError(f"{METADATA}: {entry.problem}.")
    told = _read_metadata(entry.data)
    top = entry_name(table).removesuffix(METADATA)
    files: dict[str, list[tuple[zipfile.ZipInfo, str]]] = {}
    download = Download()
    for info in archive.infolist():
        path = entry_name(info)
        if path.endswith("/") or info is table:
            continue
        folder, _, below = path.removeprefix(top).partition("/")
        if below and folder in told and told[folder].people:
            files.setdefault(folder, []).append((info, below))
        else:
            download.strays.append(path)
    for name, entries in files.items():
        people = told[name].people
        for place, person in people.items():
            number = str(_FIRST_NUMBER + len(download.participants))
            row = {column: one_line(person.get(key, "")) for key, column in _COLUMNS.items()}
            if not any(row[column] for column in (EMAIL, ID_COLUMNS[0])):  # Gradescope has no other name of a person
                row[ID_COLUMNS[0]] = f"{name}_{place}"
            row[FULL_NAME] = row[FULL_NAME] or row[EMAIL] or row[ID_COLUMNS[0]]
            download.participants[number] = Participant(row[FULL_NAME], number, list(entries))
            download.rows.append({IDENTIFIER: f"Participant {number}", **row})
            if (when := _utc(told[name].created_at)) is not None:
                download.times[number] = when
            if len(people) > 1:
                download.remarks[number] = [f"handed in by {len(people)} together ({name})"]
    return download


def _metadata_entry(archive: zipfile.ZipFile) -> zipfile.ZipInfo | None:
    """The table of an export of Gradescope: beside the folders of the submissions, where no student can put a file."""
    paths = [entry_name(info) for info in archive.infolist()]
    for info, path in zip(archive.infolist(), paths, strict=True):
        top = path.removesuffix(METADATA)
        if path.endswith(METADATA) and (top == "" or (top.endswith("/") and top.count("/") == 1)):
            beside = (one.removeprefix(top).split("/") for one in paths if one.startswith(top) and one != top)
            if all(one.startswith(top) for one in paths) and all(map(_is_of_gradescope, beside)):
                return info
    return None


def _is_of_gradescope(path: Sequence[str]) -> bool:
    return list(path) == [METADATA] or _SUBMISSION.fullmatch(path[0]) is not None


@dataclass(slots=True)
class _Submission:
    """What the table says of a submission: who handed it in, by position, and when."""

    people: dict[str, dict[str, str]] = field(default_factory=dict)
    created_at: str = ""


def _read_metadata(text: bytes) -> Mapping[str, _Submission]:
    """What the table says of each submission.

    Events are read, and no objects made of them: the table has texts of students, and marks of Ruby's types.
    """
    submissions: dict[str, _Submission] = {}
    try:
        for path, value in _scalars(text):
            match [part.removeprefix(":") for part in path]:
                case [name, "submitters", place, ("name" | "sid" | "email") as key]:
                    submissions.setdefault(name, _Submission()).people.setdefault(place, {})[key] = value
                case [name, "created_at"] | [name, "created_at", "utc"]:
                    submissions.setdefault(name, _Submission()).created_at = value
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        said = one_line(str(error))[:200]
        raise ValueError(f"{METADATA} cannot be read ({said}). Export the submissions again.") from None
    return submissions


@dataclass(slots=True)
class _Open:
    """An open table or list of a YAML document, and the key or the position at which it is."""

    is_table: bool
    key: str | None = None
    place: int = 0

    @property
    def at(self) -> str:
        return (self.key or "") if self.is_table else str(self.place)

    def step(self) -> None:
        """Go on after a value."""
        if self.is_table:
            self.key = "" if self.key is None else None  # a table or list can be a key, too
        self.place += 1


def _scalars(text: bytes) -> Iterator[tuple[list[str], str]]:
    """The plain values of a YAML document that stand at most four deep, with the keys and positions that lead there."""
    stack: list[_Open] = []
    for count, event in enumerate(yaml.parse(text, Loader=yaml.CSafeLoader)):
        if count > _MAX_EVENTS:
            raise ValueError(f"{METADATA} is too large.")
        if isinstance(event, yaml.CollectionStartEvent):
            stack.append(_Open(isinstance(event, yaml.MappingStartEvent)))
            if len(stack) > _DEEPEST:  # each event takes a time that grows with the depth
                raise ValueError(f"{METADATA} cannot be read (more than {_DEEPEST} levels). Export it again.")
            continue
        if isinstance(event, yaml.CollectionEndEvent):
            stack.pop()
        elif isinstance(event, yaml.ScalarEvent | yaml.AliasEvent):
            value = str(event.value) if isinstance(event, yaml.ScalarEvent) else ""
            if stack and stack[-1].is_table and stack[-1].key is None:
                stack[-1].key = value
                continue
            if 0 < len(stack) <= 4:
                yield [level.at for level in stack], value
        else:
            continue
        if stack:
            stack[-1].step()


def _utc(text: str) -> str | None:
    found = _TIME.search(text)
    if found is None:
        return None
    zone = "+00:00" if found[3] in ("Z", "UTC") else found[3]
    try:
        return utc_timestamp(datetime.fromisoformat(f"{found[1]}T{found[2]}{zone}"))
    except (ValueError, OverflowError):
        return None
