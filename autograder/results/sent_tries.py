"""The tries that students sent: taken from the hand-ins without names, one file for each assignment.

``OUT/tries/<assignment>.json`` has the tries of each student who sent them, in an order that says nothing of who sent
which. Each run of `grade` writes it anew, so that it has nothing of students who do not send them any more.
"""

import json
from collections.abc import Collection, Iterable
from dataclasses import astuple
from pathlib import Path

from autograder.intake.submission import is_plain_file
from labsid._files import write_text
from labsid.checks.kept_tries import MAX_BYTES, KeptTry, read_tries, tries_file_name

SCHEMA = "labsid.sent-tries/1"

StudentTries = tuple[KeptTry, ...]
"""The tries of one student at one assignment, in order."""


def gather_tries(
    submitted: Path, students: Iterable[str], assignment: str, questions: Collection[str], out: Path
) -> None:
    """Store the tries at an assignment that were sent with the hand-ins of a class.

    Parameters
    ----------
    submitted : Path
        ``<student>/<assignment>/<assignment>-tries.json``; a file that is forged, too large or a link is ignored.
    students : iterable of str
    assignment : str
    questions : collection of str
        The ids of the assignment's questions; tries at others are ignored.
    out : Path
        Receives ``tries/<assignment>.json``, or nothing if nobody sent tries.
    """
    sent = sorted(
        filter(None, (_read_sent(submitted / student / assignment, assignment, questions) for student in students))
    )
    path = _stored_path(out, assignment)
    if not sent:
        path.unlink(missing_ok=True)
        return
    document = {"schema": SCHEMA, "sent": [[astuple(attempt) for attempt in tries] for tries in sent]}
    write_text(path, json.dumps(document) + "\n")


def load_sent(out: Path, assignment: str) -> tuple[StudentTries, ...]:
    """The tries at an assignment that `gather_tries` stored; none if there is no such file, or it is damaged."""
    try:
        document = json.loads(_stored_path(out, assignment).read_text(encoding="utf-8"))
        if document["schema"] != SCHEMA:
            return ()
        return tuple(tuple(KeptTry(*fields) for fields in tries) for tries in document["sent"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ()


def _read_sent(folder: Path, assignment: str, questions: Collection[str]) -> StudentTries:
    path = folder / tries_file_name(assignment)
    if any(one.is_symlink() for one in (folder.parent, folder)) or not is_plain_file(path, MAX_BYTES):
        return ()
    try:
        return read_tries(path.read_bytes(), questions)
    except (OSError, ValueError):
        return ()


def _stored_path(out: Path, assignment: str) -> Path:
    return out / "tries" / f"{assignment}.json"
