"""Return feedback pages on a hub, so that only its student can read each.

In a shared folder, a page goes into the folder of the student, which others cannot enter. In nbgrader's exchange, it
gets the name that nbgrader gives it, which only who handed in can compute, in a folder that nobody can list. Students
own the folders that are written to: links in them are not followed, and a folder of somebody else gets nothing.
"""

import hashlib
import os
import secrets
import stat
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from autograder.course.students import known_students
from autograder.intake.hub_folder import SECRET_FILE, HubHandIn, list_hub_folder, open_folder, read_file, user_of
from labsid.hand_in.hub import FEEDBACK_PREFIX, Hub, folder_names

_MODE = 0o644
_FOLDER_MODE = 0o711
_MOST_SECRET_BYTES = 1000


def return_feedback(out: Path, hub: Hub) -> Iterator[tuple[str, int]]:
    """Return the pages that ``labsid course feedback`` wrote.

    Parameters
    ----------
    out : Path
        Folder of the graded class.
    hub : Hub

    Yields
    ------
    tuple
        A line for a student whose pages could not be returned, otherwise an empty text; and how many were returned.

    Raises
    ------
    ValueError
        If there are no pages, or the folder of the hub is not on this machine.
    """
    pages: dict[str, list[Path]] = {}
    for page in sorted((out / "feedback").glob("*/*.html")):
        pages.setdefault(page.parent.name, []).append(page)
    if not pages:
        raise ValueError(f"{out / 'feedback'} has no pages. Run: labsid course feedback --out {out}")
    users = {student.id: student.username or student.id for student in known_students(out, pages)}
    inbound = Path(hub.exchange or "", hub.course, "inbound")
    folder = _existing(hub.hand_in or inbound)
    hand_ins: Mapping[str, list[HubHandIn]] = {}
    if hub.hand_in is None:
        (inbound.parent / "feedback").mkdir(mode=_FOLDER_MODE, exist_ok=True)
        hand_ins = list_hub_folder(inbound).hand_ins
    for student, own in pages.items():
        contents, user = {page.stem: page.read_bytes() for page in own}, users[student]
        try:
            if hub.hand_in is not None:
                done = _put_into_folder(folder, user, contents)
            else:
                done = _put_into_exchange(folder, hand_ins.get(user, ()), contents)
        except (OSError, ValueError) as error:
            said = error.strerror or str(error) if isinstance(error, OSError) else str(error)
            yield f"{student}: nothing returned: {said}", 0
        else:
            yield "", done


def _existing(folder: Path) -> Path:
    if not folder.is_dir():
        raise ValueError(f"{folder}, as in [hub] of course.toml, is not on this machine. Run this command on the hub.")
    return folder


def _put_into_folder(shared: Path, user: str, pages: Mapping[str, bytes]) -> int:
    """Write pages into the first folder of a student that nobody else can enter."""
    with open_folder(shared) as top:
        owner, problem = os.fstat(top).st_uid, "no folder, and so no hand-in, in " + str(shared)
        for name in folder_names(user):
            try:
                with open_folder(name, top) as folder:
                    if user_of(folder, name, owner) != user:
                        problem = f"{shared / name} belongs to {user_of(folder, name, owner)}"
                    elif os.fstat(folder).st_mode & stat.S_IRWXO:
                        problem = f"others can enter {shared / name}; the next hand-in makes another folder"
                    else:
                        for assignment, content in pages.items():
                            _write_in(folder, f"{FEEDBACK_PREFIX}{assignment}.html", content)
                        return len(pages)
            except FileNotFoundError:
                continue
            except PermissionError:
                problem = f"you cannot write into {shared / name}; its group should be yours, its mode 2770"
        raise ValueError(problem)


def _put_into_exchange(inbound: Path, hand_ins: Sequence[HubHandIn], pages: Mapping[str, bytes]) -> int:
    """Write pages under the names by which nbgrader looks for those of a student's last hand-ins."""
    done = 0
    with open_folder(inbound) as top, open_folder(inbound.parent / "feedback") as folder:
        for assignment, content in pages.items():
            last = next((one for one in hand_ins if one.folder.split("+")[1:2] == [assignment]), None)
            if last is not None and SECRET_FILE in last.files:
                secret = read_file(top, last, SECRET_FILE, _MOST_SECRET_BYTES)
                name = hashlib.md5(secret + assignment.encode(), usedforsecurity=False).hexdigest()
                _write_in(folder, f"{name}.html", content)
                done += 1
    if not done:
        raise ValueError(f"no hand-in in {inbound}")
    return done


def _write_in(folder: int, name: str, content: bytes) -> None:
    """Write a file in an open folder; what has its name is replaced, and no link followed."""
    partial = f".{secrets.token_hex(8)}"
    descriptor = os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600, dir_fd=folder)
    try:
        with open(descriptor, "wb") as file:
            file.write(content)
            os.fchmod(file.fileno(), _MODE)  # the folder is what others cannot enter
        os.replace(partial, name, src_dir_fd=folder, dst_dir_fd=folder)
    except OSError:
        os.unlink(partial, dir_fd=folder)
        raise
