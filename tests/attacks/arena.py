"""Every attack in one batch beside two honest students, and what came of it and of what lay around it.

Loopback only. What attacks leave running is ended by the grader, which is what is tried.
"""

import hashlib
import json
import os
import re
import socket
import sqlite3
import stat
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any
from unittest import mock

import nbformat

from attacks import QUESTIONS, Attack, answers, hand_ins, processes, reach
from autograder.batch.executors import LocalExecutor
from autograder.batch.grade import grade_batch
from autograder.batch.selection import Batch, find_batch
from autograder.course.layout import Course, read_template
from autograder.course.own_secret import read_own_secret
from autograder.results import result_files
from autograder.results.feedback import write_feedback
from autograder.results.result_files import StoredResult
from autograder.sandbox.isolation import Limits, open_launcher

NAME = "prelab-sinusoids"
ATTACKS: tuple[Attack, ...] = (*processes.ATTACKS, *answers.ATTACKS, *reach.ATTACKS, *hand_ins.ATTACKS)
ON_ITS_PROCESS: tuple[Attack, ...] = (*processes.ATTACKS, *reach.ATTACKS)
"""What reaches for files, the network, signals and processes: in these the levels differ. What comes over the channel,
or is handed in, does not depend on the level."""
HONEST = ("honest-ada", "honest-ben")
SECRET = b"the secret of this course"
_MAX_READ = 1 << 30  # a sparse file may be larger than any disk
LIMITS = Limits(
    cell_seconds=2,
    call_seconds=2,
    submission_seconds=12,  # two runs, each with an attack that ends at the limit of its cell
    memory_bytes=1 << 30,
    file_bytes=4 << 20,
    disk_bytes=8 << 20,
    processes=24,
    cpu_seconds=20,
    cells=60,
)


def student_of(attack: Attack) -> str:
    return re.sub(r"\W+", "-", f"{attack.name}").strip("-")


@dataclass(frozen=True)
class Outcome:
    """What came of the batch, and of what was around it."""

    level: str
    out: Path
    results: dict[str, StoredResult]
    pages: dict[str, str]
    alone: dict[str, StoredResult]
    untouched: dict[str, bool]
    left_running: list[str]
    left_behind: list[str]

    def touched(self) -> list[str]:
        """What must be as it was and is not: on the last level, files that a sandbox alone protects do not count."""
        kept = {"course", "hand-ins", "grades"} | ({"gradebook", "left"} if self.level != "none" else set())
        return [place for place in sorted(kept) if not self.untouched[place]]

    def harmed(self) -> list[str]:
        """Honest students who get something else than without attackers."""
        return [one for one in HONEST if as_graded(self.results[one]) != as_graded(self.alone[one])]


def scores_of(result: StoredResult) -> dict[str, Decimal | None]:
    """The scores of the automatic questions."""
    return {one.question: one.score for one in result.questions if one.question in QUESTIONS}


def due_to(attack: Attack, course: Course) -> dict[str, Decimal | None]:
    """The scores that an attack must get."""
    worth = {cell.id: cell.points for cell in read_template(course, NAME).questions}
    return {question: Decimal(0) if question in attack.loses else worth[question] for question in QUESTIONS}


def as_graded(result: StoredResult) -> list[tuple[Any, ...]]:
    return [(one.question, one.score, one.status, one.reason, one.output, one.figures) for one in result.questions]


def fight(
    course: Course,
    folder: Path,
    isolation: str,
    attacks: Sequence[Attack] = ATTACKS,
    secret: bytes | None = SECRET,
) -> Outcome:
    """Grade the honest alone, then with the attackers, on a level of the ladder.

    Parameters
    ----------
    course : Course
        Built.
    folder : Path
        Empty.
    isolation : str
    attacks : sequence of Attack
    secret : bytes or None
        Secret of individual data; None for a course without, whose own secret is the one to find then.
    """
    withheld = read_own_secret(course) if secret is None else secret
    submitted, earlier = folder / "submitted", folder / "earlier"
    mark = f"attack{os.getpid()}"  # others may fight on this machine at the same time
    left = Path("/dev/shm" if os.path.isdir("/dev/shm") else "/tmp", mark)
    model = nbformat.read(course.source / NAME / f"{NAME}.ipynb", as_version=4)
    notebook = json.loads(nbformat.writes(model))
    honest(submitted, notebook)
    for path in (*folder.parents, course.root.parent, course.root):  # rights of files must not do the sandbox's work
        if path.stat().st_uid == os.getuid() and path != Path("/"):
            path.chmod(path.stat().st_mode | stat.S_IXOTH | stat.S_IROTH)
    earlier.mkdir()
    with sqlite3.connect(earlier / "gradebook.db") as book:
        book.execute("CREATE TABLE grade AS SELECT 0.5 AS score")
    book.close()
    (earlier / "gradebook.db").chmod(0o666)
    earlier.chmod(0o777)
    same = mock.patch("autograder.batch.fingerprint.sources_hash", return_value="the same")  # whoever edits meanwhile
    with socket.create_server(("127.0.0.1", 0)) as listener, same:
        listener.setblocking(False)
        with open_launcher(isolation, LIMITS) as launcher:
            alone = run(course, find_batch(course, submitted, NAME), folder / "alone", launcher, secret)
            here = {
                "grader": os.getpid(),
                "parent": getattr(launcher, "fork_server_pid", 0),
                "secret": withheld.decode(),
                "solution": str(course.source / NAME / f"{NAME}.ipynb"),
                "other": str(submitted / HONEST[0] / NAME / f"{NAME}.ipynb"),
                "gradebook": str(earlier / "gradebook.db"),
                "shared": str(left),
                "mark": mark,
                "port": listener.getsockname()[1],
            }
            for attack in attacks:
                lay_out(attack, submitted / student_of(attack) / NAME, notebook, here)
            before = {place: digest(place) for place in (course.root, submitted, earlier, folder / "alone")}
            batch = find_batch(course, submitted, NAME)
            found = run(course, batch, folder / "out", launcher, secret, jobs=6)
            level = launcher.level
        try:
            listener.accept()[0].close()
            asked = True
        except BlockingIOError:
            asked = False
    untouched = {
        "course": before[course.root] == digest(course.root),
        "hand-ins": before[submitted] == digest(submitted),
        "gradebook": before[earlier] == digest(earlier),
        "grades": before[folder / "alone"] == digest(folder / "alone"),
        "left": not left.exists(),
        "listener": not asked,
    }
    left.unlink(missing_ok=True)
    workdirs_now = sorted(path.name for path in Path(tempfile.gettempdir()).glob(f"labsid-workdir-{os.getpid()}-*"))
    pages = {path.parent.name: path.read_text(encoding="utf-8") for path in write_feedback(folder / "out")}
    return Outcome(level, folder / "out", found, pages, alone, untouched, running(mark), workdirs_now)


def run(
    course: Course, batch: Batch, out: Path, launcher: Any, secret: bytes | None, jobs: int = 1
) -> dict[str, StoredResult]:
    done = list(grade_batch(course, batch, out, LocalExecutor(launcher, jobs), secret))
    assert sorted(one.student for one in done) == sorted(batch.students)
    return {one.student: one for one in result_files.load_all(out)}


def honest(submitted: Path, notebook: dict[str, Any]) -> None:
    """Ada is right; ben cuts off one sample too few."""
    for student, slip in zip(HONEST, (False, True), strict=True):
        folder = submitted / student / NAME
        folder.mkdir(parents=True)
        text = json.dumps(notebook)
        (folder / f"{NAME}.ipynb").write_text(text.replace("y1[200:]", "y1[199:-1]") if slip else text, "utf-8")


def lay_out(attack: Attack, folder: Path, notebook: dict[str, Any], here: dict[str, Any]) -> None:
    folder.mkdir(parents=True)
    mine = json.loads(json.dumps(notebook))
    cells: list[dict[str, Any]] = []
    answered = {f"{question}-answer": code for question, code in attack.answers.items()}
    added = {f"{question}-answer": codes for question, codes in attack.extras.items()}
    for cell in mine["cells"]:
        if cell["id"] in answered:
            cell["source"] = f"HERE = {here!r}\n{answered[cell['id']]}"
        cells.append(cell)
        for code in added.get(cell["id"], ()):
            added_cell = {"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None}
            cells.append({**added_cell, "source": f"HERE = {here!r}\n{code}" if "HERE" in code else code})
    mine["cells"] = cells
    unknown = (set(answered) | set(added)) - {cell.get("id") for cell in cells}
    assert not unknown, unknown
    if attack.hand_in is not None:
        attack.hand_in(folder, mine)
    else:
        (folder / f"{NAME}.ipynb").write_text(json.dumps(mine), encoding="utf-8")


def digest(folder: Path) -> str:
    """Of the names, kinds and content of everything in a folder."""
    seen = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        kind = path.lstat().st_mode
        seen.update(f"{path.relative_to(folder)}\0{stat.S_IFMT(kind)}\0".encode())
        if stat.S_ISREG(kind) and path.stat().st_size < _MAX_READ:
            seen.update(path.read_bytes())
    return seen.hexdigest()


def running(name: str) -> list[str]:
    """The processes of that name."""
    found = []
    for comm in Path("/proc").glob("[0-9]*/comm"):
        try:
            if comm.read_text(encoding="utf-8").strip() == name:
                found.append(comm.parent.name)
        except OSError:
            pass
    return found
