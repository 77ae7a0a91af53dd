"""Hand-ins in a shared folder of a hub, or in the inbound folder of nbgrader's exchange.

Whose a hand-in is, and when it was made, is what the file system says: the owner of the folder and of the files in it,
and the time of their last change of any kind (ctime), neither of which a student can set. Names of files and folders,
``timestamp.txt`` and what a notebook says of itself decide nothing. Links are not followed.

On a hub of containers all students are one user. Then the administrator makes the folder of each student and mounts it
alone into that student's container: a folder that belongs to the owner of the shared folder is that of its name.
"""

import os
import pwd
import stat
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import IO

from autograder.course.archive import Budget
from autograder.course.plain_text import one_line, shortened
from autograder.intake.download import HandIn, Participant, read_hand_in
from autograder.intake.worksheet import folder_name
from labsid.checks.cells import Template

MOST_HAND_INS = 50
"""Hand-ins of one student that are read, the newest ones."""

MOST_FILES = 100
"""Files of one hand-in that are read."""

SECRET_FILE = "submission_secret.txt"
"""What nbgrader derives the name of a feedback page from, in a hand-in of its exchange."""

_OWN_FILES = (f"/{SECRET_FILE}", "/timestamp.txt", "/feedback.html")  # what nbgrader and labsid put beside a notebook
_PLUS = "+"  # between user, assignment and time in the names of nbgrader's folders


@dataclass(frozen=True, slots=True)
class HubHandIn:
    """One hand-in of a user.

    Attributes
    ----------
    user : str
        The name with which the student logs in.
    folder : str
        Name of its folder below the shared one; empty for a file that lies beside the folders.
    files : tuple of str
    owner : int
        Number of the user who owns the files.
    time : float
        Of its last change, in seconds since the epoch.
    """

    user: str
    folder: str
    files: tuple[str, ...]
    owner: int
    time: float


@dataclass(slots=True)
class HubFolder:
    """What is in a shared folder.

    Attributes
    ----------
    hand_ins : dict
        By user, the newest first.
    strays : list of str
        What belongs to nobody or cannot be read, and why.
    """

    hand_ins: dict[str, list[HubHandIn]] = field(default_factory=dict)
    strays: list[str] = field(default_factory=list)


def list_hub_folder(path: Path) -> HubFolder:
    """The hand-ins below a shared folder.

    Raises
    ------
    OSError
        If the folder cannot be listed.
    """
    found = HubFolder()
    with open_folder(path) as top:
        owner = os.fstat(top).st_uid
        for name in sorted(os.listdir(top)):
            if name.startswith("."):
                continue
            try:
                hand_ins = list(_hand_ins_in(top, name, owner))
            except OSError as error:
                found.strays.append(f"{shortened(name)} ({error.strerror or error})")
                continue
            except ValueError as error:
                found.strays.append(f"{shortened(name)} ({error})")
                continue
            for hand_in in hand_ins:
                found.hand_ins.setdefault(hand_in.user, []).append(hand_in)
    for own in found.hand_ins.values():
        own.sort(key=lambda hand_in: (hand_in.time, hand_in.folder, hand_in.files), reverse=True)
    return found


@contextmanager
def open_folder(path: "Path | str", below: int | None = None) -> Iterator[int]:
    """A descriptor of a folder, which is no link if it is below another one."""
    flags = os.O_RDONLY | os.O_DIRECTORY | (0 if below is None else os.O_NOFOLLOW)
    descriptor = os.open(path, flags, dir_fd=below)
    try:
        yield descriptor
    finally:
        os.close(descriptor)


def user_of(folder: int, name: str, top_owner: int) -> str:
    """Whose the open folder is; `ValueError` if it is nobody's.

    Parameters
    ----------
    folder : int
        Descriptor.
    name : str
        Its name, which counts only if it belongs to the owner of the shared folder.
    top_owner : int
    """
    owner = os.fstat(folder).st_uid
    user = name.partition(_PLUS)[0] if owner == top_owner else _name_of(owner)
    if folder_name(user) is None:
        raise ValueError(f"{shortened(user)} cannot be the ID of a student")
    return user


def _name_of(owner: int) -> str:
    try:
        return pwd.getpwuid(owner).pw_name
    except KeyError:
        raise ValueError(f"the user with the number {owner} is not known on this machine") from None


def _hand_ins_in(top: int, name: str, top_owner: int) -> Iterator[HubHandIn]:
    """The hand-ins in one folder, or the one that is a file; `ValueError` says why it is none."""
    found = os.stat(name, dir_fd=top, follow_symlinks=False)
    if stat.S_ISREG(found.st_mode):
        if found.st_uid == top_owner:
            raise ValueError("it belongs to the owner of the folder")
        yield HubHandIn(_name_of(found.st_uid), "", (name,), found.st_uid, found.st_ctime)
        return
    if not stat.S_ISDIR(found.st_mode):
        raise ValueError("neither a file nor a folder")
    with open_folder(name, top) as folder:
        user, owner = user_of(folder, name, top_owner), os.fstat(folder).st_uid
        times: dict[str, float] = {}
        for file in sorted(os.listdir(folder)):
            inner = os.stat(file, dir_fd=folder, follow_symlinks=False)
            if not file.startswith(".") and stat.S_ISREG(inner.st_mode) and inner.st_uid == owner:
                times[file] = inner.st_ctime
        if _PLUS in name:  # one of nbgrader's, which is one hand-in
            if times:
                yield HubHandIn(user, name, tuple(times)[:MOST_FILES], owner, max(times.values()))
            return
        for file, time in times.items():
            if file.lower().endswith((".zip", ".ipynb")):
                yield HubHandIn(user, name, (file,), owner, time)


def read_file(top: int, hand_in: HubHandIn, name: str, most: int) -> bytes:
    """The content of a file of a hand-in, at most `most` bytes.

    Raises
    ------
    ValueError
        If it is not any more a file of that user, or too large.
    """
    with open_folder(hand_in.folder or ".", top) as folder:
        descriptor = os.open(name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK, dir_fd=folder)
        with open(descriptor, "rb") as file:
            found = os.fstat(file.fileno())
            if not stat.S_ISREG(found.st_mode) or found.st_uid != hand_in.owner:
                raise ValueError("it is not a file of this user")
            content = file.read(most + 1)
    if len(content) > most:
        raise ValueError(f"it has more than {most // 1_000_000} MB")
    return content


@dataclass(frozen=True, slots=True)
class ReadHandIns:
    """What a student handed in: of each assignment the last, and when."""

    hand_in: HandIn
    times: Mapping[str, datetime]


def read_hub_hand_ins(
    top: int,
    hand_ins: list[HubHandIn],
    templates: Mapping[str, Template],
    budget: Budget,
    most_bytes: int,
    scratch: IO[bytes],
) -> ReadHandIns:
    """Read the hand-ins of one student, the newest first, until each assignment in them was found.

    Parameters
    ----------
    top : int
        Descriptor of the shared folder.
    hand_ins : list of HubHandIn
        The newest first.
    templates : mapping
        Template by assignment.
    budget : Budget
        Of this student.
    most_bytes : int
        Of one file.
    scratch : file
        Takes the files while they are read.
    """
    merged, times = HandIn(), dict[str, datetime]()
    for hand_in in hand_ins[:MOST_HAND_INS]:
        found = _read_one(top, hand_in, templates, budget, most_bytes, scratch)
        new = [name for name in found.versions if name not in merged.versions]
        first = not merged.versions
        merged.unread += [(name, why) for name, why in found.unread if (first if name is None else name not in times)]
        for name in new:
            merged.versions[name] = found.versions[name]
            times[name] = datetime.fromtimestamp(hand_in.time, UTC)
        merged.untouched |= found.untouched
        if new or first:
            merged.skipped += found.skipped
            merged.left_out += found.left_out
            for name, copies in found.data.items():
                merged.data.setdefault(name, []).extend(copies)
            for name, copies in found.tries.items():
                merged.tries.setdefault(name, []).extend(copies)
        merged.problem = merged.problem or found.problem
        if found.problem:  # the budget is used up
            break
    if len(hand_ins) > MOST_HAND_INS:
        merged.skipped.append(f"{len(hand_ins) - MOST_HAND_INS} older hand-ins of {len(hand_ins)}")
    return ReadHandIns(merged, times)


def _read_one(
    top: int,
    hand_in: HubHandIn,
    templates: Mapping[str, Template],
    budget: Budget,
    most_bytes: int,
    scratch: IO[bytes],
) -> HandIn:
    """Read one hand-in as one of a download: its files are packed first, so that limits and remarks are the same."""
    scratch.seek(0)
    scratch.truncate()
    refused: list[str] = []
    left = budget.left
    date = max(datetime.fromtimestamp(hand_in.time, UTC), datetime(1980, 1, 1, tzinfo=UTC)).timetuple()[:6]
    with zipfile.ZipFile(scratch, "w", zipfile.ZIP_STORED) as packed:
        for name in hand_in.files:
            try:
                content = read_file(top, hand_in, name, min(most_bytes, left))
            except (OSError, ValueError) as error:
                said = error.strerror if isinstance(error, OSError) else str(error)
                refused.append(one_line(f"{shortened(name)}: {said}"))
                continue
            left -= len(content)
            with suppress(ValueError, UnicodeEncodeError):  # a name that no zip file can have
                packed.writestr(zipfile.ZipInfo("/".join(filter(None, (hand_in.folder, name))), date), content)
    with zipfile.ZipFile(scratch) as archive:
        entries = [(info, info.filename) for info in archive.infolist()]
        found = read_hand_in(archive, Participant(hand_in.user, "0", entries), templates, budget)
    found.skipped = [said for said in found.skipped if not said.endswith(_OWN_FILES)]
    found.unread += [(None, said) for said in refused]
    found.skipped += refused
    return found
