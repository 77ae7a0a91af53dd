"""The zip file of Moodle's "Download all submissions": whose is which file, and what the files of one participant are.

Moodle makes a folder ``Full Name_123456_assignsubmission_file_`` for each participant or, with folders disabled, files
with this prefix; 123456 is the participant number. Students choose the names of their files, and what is in them.
"""

import re
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from autograder.course.archive import (
    ArchiveEntry,
    Budget,
    OverBudgetError,
    entry_name,
    read_entries,
    read_packed,
)
from autograder.course.plain_text import shortened
from autograder.intake.alignment import share_of_given_cells
from autograder.intake.submission import cells_of, is_as_released, read_notebook
from autograder.intake.untrusted_json import reading_work
from autograder.intake.versions import NOTEBOOK_ENDING, Version
from labsid.checks.cells import Template
from labsid.checks.kept_tries import MAX_BYTES, tries_file_name
from labsid.checks.notebook import find_assignment

_MARKER = r"_(?P<number>\d{1,18})_assignsubmission_[a-z]+_?"
_FOLDER = re.compile(rf"(?P<name>[^/]*){_MARKER}(?P<rest>)", re.ASCII)
_FILE = re.compile(rf"(?P<name>[^/]*?){_MARKER}(?P<rest>[^/]+)", re.ASCII)
_AUTOMATIC = frozenset(("__MACOSX", ".ipynb_checkpoints"))  # folders of copies that macOS and Jupyter make
_OF_SYSTEMS = frozenset((".DS_Store", "Thumbs.db", "desktop.ini"))
_OF_THE_COURSE = 0.5  # share of the given cells by which a notebook without metadata is known
_NOT_OF_THE_COURSE = "not a notebook of this course"
_ONE_MARKER = re.compile(r"_\d{1,18}_assignsubmission_", re.ASCII)


@dataclass(frozen=True, slots=True)
class Participant:
    """One participant of a download.

    Attributes
    ----------
    name, number : str
    entries : list of (ZipInfo, str)
        Entries of the download, and the path of each below the participant's folder.
    """

    name: str
    number: str
    entries: list[tuple[zipfile.ZipInfo, str]] = field(default_factory=list)


@dataclass(slots=True)
class HandIn:
    """What one participant handed in.

    Attributes
    ----------
    versions : dict
        Copies of the notebook of each assignment, without those that are as they were released.
    untouched : set of str
        Assignments of which there is a notebook as it was released.
    data : dict
        Copies of each data file, by its name.
    tries : dict
        Copies of the tries at each assignment that the participant chose to send, by the file's name.
    skipped : list of str
        Files that were not taken, and why.
    left_out : list of str
        Copies that programs make by themselves, which are no hand-in.
    unread : list of (str or None, str)
        What is or may hold a notebook and could not be read: the assignment that its path names, and why.
    problem : str
        Why not everything was read; otherwise empty.
    """

    versions: dict[str, list[Version]] = field(default_factory=dict)
    untouched: set[str] = field(default_factory=set)
    data: dict[str, list[Version]] = field(default_factory=dict)
    tries: dict[str, list[Version]] = field(default_factory=dict)
    skipped: list[str] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    unread: list[tuple[str | None, str]] = field(default_factory=list)
    problem: str = ""


def is_of_moodle(path: str) -> bool:
    """Whether a path is that of a file or folder of a participant in a download from Moodle."""
    return _match_owner(path)[0] is not None


def list_participants(archive: zipfile.ZipFile) -> tuple[dict[str, Participant], list[str]]:
    """The participants of a download by number, and the files of none."""
    participants: dict[str, Participant] = {}
    strays: list[str] = []
    for info in archive.infolist():
        name = entry_name(info)
        owner, below = _match_owner(name)
        if owner is None:
            strays += [] if name.endswith("/") else [below]
            continue
        number = owner["number"].lstrip("0") or "0"
        participants.setdefault(number, Participant(owner["name"], number)).entries.append((info, below))
    return participants, strays


def read_hand_in(
    archive: zipfile.ZipFile, participant: Participant, templates: Mapping[str, Template], budget: Budget
) -> HandIn:
    """Read the files of one participant; whatever goes wrong is a remark."""
    hand_in = HandIn()
    paths = {id(info): path for info, path in participant.entries}
    try:
        for info, _ in participant.entries:
            for entry in read_entries(archive, [info], budget):
                _add_outer(hand_in, entry, paths[id(info)], templates, budget)
    except OverBudgetError as error:
        hand_in.problem = f"not everything was read: {error}"
    except Exception as error:  # of what students hand in, no list of errors is complete
        hand_in.problem = f"not everything was read: {type(error).__name__}: {str(error)[:100]}"
    if hand_in.problem:
        hand_in.unread.append((None, hand_in.problem))
    if not hand_in.versions and not hand_in.untouched:  # it is no hand-in, but something was handed in
        hand_in.unread += [(None, said) for said in hand_in.skipped if said.endswith(_NOT_OF_THE_COURSE)]
    return hand_in


def _add_outer(
    found: HandIn, entry: ArchiveEntry, path: str, templates: Mapping[str, Template], budget: Budget
) -> None:
    """Add a file of the download, or the files in it if it is a zip file."""
    if entry.problem or not path.lower().endswith(".zip"):
        _add_file(found, path, entry, None, templates, budget)
        return
    try:
        for inner in read_packed(entry.data, path, budget):
            _add_file(found, f"{path}/{inner.name}", inner, entry, templates, budget)
    except OverBudgetError:
        raise
    except Exception as error:  # of what students hand in, no list of errors is complete
        said = shortened(str(error).rstrip(".")) or f"{shortened(path)}: {type(error).__name__}"
        found.skipped.append(said)
        found.unread.append((_named_in(path, templates), said))


def _match_owner(path: str) -> tuple[re.Match[str] | None, str]:
    """Match the participant in a path, a folder at any depth or a file prefix; also returns the path below it.

    Students choose their names and those of their files, so that these may contain the marker of another participant.
    In the name of a folder, which ends with it, the last marker is Moodle's; a file with several has no known owner.
    """
    parts = [part for part in path.split("/") if part not in ("", ".")]
    for index, part in enumerate(parts if path.endswith("/") else parts[:-1]):
        matched = _FOLDER.fullmatch(part)
        if matched is not None:
            return matched, "/".join(parts[index + 1 :])
    matched = _FILE.fullmatch(parts[-1]) if parts and len(_ONE_MARKER.findall(parts[-1])) == 1 else None
    return matched, path if matched is None else matched["rest"]


def _add_file(
    hand_in: HandIn,
    path: str,
    entry: ArchiveEntry,
    packed_in: ArchiveEntry | None,
    templates: Mapping[str, Template],
    budget: Budget,
) -> None:
    """Add a file to a hand-in: a notebook of an assignment, a data file, or skipped."""
    *folders, base = path.split("/")
    if base in _OF_SYSTEMS or base.startswith("._"):
        return
    if not _AUTOMATIC.isdisjoint(folders):
        hand_in.left_out.append(shortened(path))
        return
    times = (entry.modified, None) if packed_in is None else (packed_in.modified, entry.modified)
    if entry.problem:
        hand_in.skipped.append(f"{shortened(path)}: {entry.problem}")
        if NOTEBOOK_ENDING.search(base) or base.lower().endswith(".zip"):
            hand_in.unread.append((_named_in(path, templates), hand_in.skipped[-1]))
    elif NOTEBOOK_ENDING.search(base):
        over: OverBudgetError | None = None
        try:
            budget.charge(reading_work(entry.data))
            name, work, is_untouched = _recognise(entry.data, path, templates)
            is_readable = work is not entry.data
        except OverBudgetError as error:  # unread, but handed in
            over, name, work, is_untouched = error, _named_in(path, templates), entry.data, False
            is_readable = True
        if name is None:
            hand_in.skipped.append(f"{shortened(path)}: {_NOT_OF_THE_COURSE}")
        elif is_untouched:
            hand_in.untouched.add(name)
        else:
            hand_in.versions.setdefault(name, []).append(Version(path, name, *times, work, entry.data, is_readable))
        if over is not None:
            raise over
    elif base in {tries_file_name(name) for name in templates}:
        if len(entry.data) <= MAX_BYTES:
            hand_in.tries.setdefault(base, []).append(Version(path, base, *times, entry.data, entry.data))
    elif base in _data_files(tuple(templates)):
        stem = base.rpartition(".")[0]
        hand_in.data.setdefault(base, []).append(Version(path, stem, *times, entry.data, entry.data))
    else:
        hand_in.skipped.append(shortened(path))


@cache
def _data_files(assignments: tuple[str, ...]) -> frozenset[str | None]:
    return frozenset(find_assignment(name).record_file for name in assignments)


def _recognise(content: bytes, path: str, templates: Mapping[str, Template]) -> tuple[str | None, object, bool]:
    """The assignment of a notebook, what the student wrote in it, and whether that is nothing.

    The assignment is the one whose cells it contains, by their ids or, in a notebook without metadata, by their text;
    otherwise the one that its path names. If it cannot be read, what the student wrote is the content itself.
    """
    try:
        raw = read_notebook(content)
        ids = {_grade_id(cell) for cell in raw["cells"]} if isinstance(raw, dict) and "cells" in raw else set()
    except Exception:  # of what students hand in, no list of errors is complete
        return _named_in(path, templates), content, False
    shared = {name: len(ids & {cell.id for cell in template.cells}) for name, template in templates.items()}
    largest = max(shared.values(), default=0)
    if largest:
        name = next(name for name, count in shared.items() if count == largest)
    elif (named := _with_text_of(raw, templates) or _named_in(path, templates)) is not None:
        name = named
    else:
        return None, content, False
    try:
        cells = cells_of(raw)
        work: Sequence[tuple[Any, Any]] = [(cell["id"], cell["source"]) for cell in cells]
        return name, work, is_as_released(cells, templates[name])
    except Exception:  # of what students hand in, no list of errors is complete
        return name, content, False


def _with_text_of(raw: Any, templates: Mapping[str, Template]) -> str | None:
    """The assignment whose given cells a notebook without metadata has; None if it has too few of any."""
    try:
        cells = cells_of(raw)
        shares = {name: share_of_given_cells(cells, template) for name, template in templates.items()}
    except Exception:  # of what students hand in, no list of errors is complete
        return None
    best = max(shares, key=lambda name: shares[name], default=None)
    return best if best is not None and shares[best] >= _OF_THE_COURSE else None


def _named_in(path: str, templates: Mapping[str, Template]) -> str | None:
    named = [name for name in templates if name in path.lower()]
    return max(named, key=len) if named else None


def _grade_id(cell: Any) -> str | None:
    try:
        return str(cell["metadata"]["nbgrader"]["grade_id"])
    except (KeyError, TypeError, IndexError):
        return None
