"""Hand-in on a JupyterHub: into the shared folder of the course, or with nbgrader's exchange; and feedback from there.

The shared folder can be written by everybody and listed by instructors alone (mode 3773). Each student has a folder in
it, which only that student and the group of the instructors can enter. The instructors put the feedback there.
"""

import getpass
import json
import os
import re
import secrets
import stat
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from labsid._files import write_file
from labsid.checks.notebook_file import release_folder

HUB_FILE = "hub.json"
"""Where students hand in, beside the released notebooks in the package that they install."""

MOST_FOLDERS = 9
"""Names that are tried for the folder of a student, because somebody else may have taken one."""

FEEDBACK_PREFIX = "feedback-"
_OF_OTHERS = stat.S_IRWXO
_SHARED_USER = "jovyan"  # the only user of Jupyter's container images


@dataclass(frozen=True, slots=True)
class Hub:
    """Where students of a course hand in on a hub: one of the two.

    Attributes
    ----------
    hand_in : Path or None
        The shared folder.
    exchange : Path or None
        The root of nbgrader's exchange.
    course : str
        Name of the course in the exchange; empty without one.
    """

    hand_in: Path | None = None
    exchange: Path | None = None
    course: str = ""

    def to_json(self) -> bytes:
        """The content of `HUB_FILE`."""
        named = {"hand-in": self.hand_in, "exchange": self.exchange}
        found = {key: str(path) for key, path in named.items() if path is not None}
        return (json.dumps(found | ({"course": self.course} if self.course else {}), indent=1) + "\n").encode()


def read_hub() -> Hub | None:
    """Where the release on this machine says that students hand in; None if it does not say so."""
    release = release_folder()
    if release is None or not (release / HUB_FILE).is_file():
        return None
    found = json.loads((release / HUB_FILE).read_text(encoding="utf-8"))
    hand_in, exchange = (Path(found[key]) if key in found else None for key in ("hand-in", "exchange"))
    return Hub(hand_in, exchange, found.get("course", ""))


def user_name() -> str:
    """The name with which this user is known to the hub."""
    try:
        name = getpass.getuser()
    except (KeyError, OSError):  # a number without a name, as in some containers
        name = _SHARED_USER
    return os.environ.get("JUPYTERHUB_USER", name) if name == _SHARED_USER else name


def folder_names(user: str) -> list[str]:
    """The names of the folders that may be a student's in the shared folder, in the order in which they are tried."""
    return [user, *(f"{user}-{number}" for number in range(2, MOST_FOLDERS + 1))]


def put_into_folder(shared: Path, content: bytes, now: datetime) -> Path:
    """Write a hand-in into the student's folder below the shared folder.

    Parameters
    ----------
    shared : Path
    content : bytes
        The zip file.
    now : datetime
        For its name.

    Returns
    -------
    Path
        The file: of its owner and the group of the instructors alone, if the shared folder hands down its group.

    Raises
    ------
    ValueError
        If the shared folder is not there, or all names of the student's folder are taken.
    """
    folder = _own_folder(shared, user_name())
    name = f"{now.astimezone(UTC):%Y-%m-%d-%H%M%S}-{secrets.token_hex(4)}"
    partial = folder / f".{name}.partial"
    with _umask(0o027), partial.open("xb") as file:
        file.write(content)
    return partial.rename(folder / f"{name}.zip")


def own_folders(shared: Path, user: str) -> Iterator[tuple[Path, os.stat_result]]:
    """The folders of this user below the shared folder that nobody else but the instructors can enter."""
    for name in folder_names(user):
        try:
            found = (shared / name).lstat()
        except OSError:
            continue
        if stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & _OF_OTHERS:
            yield shared / name, found


def _hands_down_group(folder: os.stat_result, shared: os.stat_result) -> bool:
    """Whether files in a folder get the group of the instructors, where the shared folder says which."""
    if not shared.st_mode & stat.S_ISGID or shared.st_uid == os.getuid():
        return True
    return folder.st_gid == shared.st_gid and bool(folder.st_mode & stat.S_ISGID)


def _own_folder(shared: Path, user: str) -> Path:
    if not shared.is_dir():
        raise ValueError(
            f"{shared}, the folder of the course for hand-ins, is not on this machine. Run labsid submit on the hub of "
            "the course, or write a file with --out FILE."
        )
    top = shared.stat()
    for own, found in own_folders(shared, user):
        if _hands_down_group(found, top):
            return own
    for name in folder_names(user):
        try:
            with _umask(0o007):
                (shared / name).mkdir(mode=0o770)
        except FileExistsError:  # somebody else's, or one that others can enter
            continue
        except PermissionError:
            raise ValueError(
                f"nothing can be written into {shared}. Tell your instructor; its mode should be 3773."
            ) from None
        return shared / name
    raise ValueError(
        f"the folders {user} to {user}-{MOST_FOLDERS} in {shared} are not yours, or others can enter them. Tell your "
        "instructor, who sees whose they are."
    )


@contextmanager
def _umask(mask: int) -> Iterator[None]:
    before = os.umask(mask)
    try:
        yield
    finally:
        os.umask(before)


def fetch_from_folder(shared: Path, work: Path) -> list[Path]:
    """Copy the feedback in the student's folder beside the notebooks; returns the files that are new or changed."""
    written = []
    for folder, _ in own_folders(shared, user_name()):
        for page in sorted(folder.glob(f"{FEEDBACK_PREFIX}*.html")):
            target = work / page.stem.removeprefix(FEEDBACK_PREFIX) / "feedback.html"
            content = page.read_bytes()
            if target.is_file() and target.read_bytes() == content:
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            write_file(target, content)
            written.append(target)
    return written


def hand_in_with_nbgrader(hub: Hub, work: Path, assignments: Sequence[str]) -> list[str]:
    """Hand in each assignment with ``nbgrader submit``; returns those that were.

    Raises
    ------
    ValueError
        If nbgrader is not installed, or refuses one; it says why.
    """
    for done, name in enumerate(assignments):
        said = _nbgrader(hub, work, "submit", name)
        if said:
            handed_in = f" Handed in: {', '.join(assignments[:done])}." if done else ""
            raise ValueError(f"nbgrader submit {name}: {said}.{handed_in}")
    return list(assignments)


def fetch_with_nbgrader(hub: Hub, work: Path, assignments: Sequence[str]) -> list[Path]:
    """Fetch feedback with ``nbgrader fetch_feedback``; returns the pages, by assignment and time of the hand-in."""
    for name in assignments:
        said = _nbgrader(hub, work, "fetch_feedback", name)
        if said:
            raise ValueError(f"nbgrader fetch_feedback {name}: {said}.")
    return sorted(path for name in assignments for path in work.glob(f"{name}/feedback/*/*.html"))


def _nbgrader(hub: Hub, work: Path, command: str, assignment: str) -> str:
    """Run a command of nbgrader for one assignment; returns why it failed, or an empty text."""
    settings = [f"--Exchange.root={hub.exchange}", f"--course={hub.course}"]
    done = subprocess.run(
        [sys.executable, "-m", "nbgrader", command, assignment, *settings],
        cwd=work,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode == 0:
        return ""
    if "No module named nbgrader" in done.stderr:
        return "nbgrader is not installed where this notebook runs; ask for it, or hand in with its button"
    lines = [line for line in done.stderr.splitlines() if line.strip()]
    return re.sub(r"^\[.*?\]\s*", "", lines[-1]).rstrip(".") if lines else f"it ended with status {done.returncode}"
