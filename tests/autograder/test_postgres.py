"""A gradebook in PostgreSQL, on a server of its own that these tests start: the same as the file, in every respect."""

import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest
from course_work import give_by_hand, scores_in_gradebook

from autograder.batch.executors import LocalExecutor
from autograder.batch.grade import grade_batch
from autograder.batch.selection import find_batch
from autograder.course.layout import Course
from autograder.course.nbgrader_access import open_gradebook
from autograder.results import gradebook, result_files
from autograder.results.bulk_entry import BulkEntry
from autograder.samples import write_samples
from autograder.sandbox.isolation import ProcessLauncher
from labsid.cli.commands import main

PRELAB, LAB = "prelab-sinusoids", "lab-identification"
OPEN = "prelab-6-clock"

pwd = pytest.importorskip("pwd", reason="a server of one's own is started here on POSIX systems alone")


def program(name: str) -> str:
    """One of PostgreSQL's programs, which Debian keeps out of the path."""
    found = shutil.which(name) or next(iter(sorted(glob.glob(f"/usr/lib/postgresql/*/bin/{name}"), reverse=True)), "")
    if not found:
        pytest.skip(f"PostgreSQL's server is not on this machine ({name} is missing); apt-get install postgresql")
    return found


@dataclass(frozen=True)
class Server:
    """A running server, spoken to over a socket in its own folder."""

    folder: Path
    user: str | None
    """Whose it is: PostgreSQL refuses to be root's."""

    def run(self, name: str, *options: str) -> None:
        command = [program(name), *options]
        done = subprocess.run(command, user=self.user, cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr

    def control(self, *what: str) -> None:
        """Start or stop it; what it says later goes to a file, or it would be waited for."""
        self.run("pg_ctl", "-D", f"{self.folder}/data", "-l", f"{self.folder}/log", "-w", *what)

    def database(self, name: str) -> str:
        """Make an empty database; its address."""
        self.run("createdb", "-h", str(self.folder), "-U", "labsid", name)
        return f"postgresql+psycopg://labsid@/{name}?host={self.folder}"


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    """PostgreSQL on a socket alone: it listens to no network."""
    pytest.importorskip("psycopg", reason="pip install 'labsid[postgres]'")
    program("initdb")
    user = None
    if os.geteuid() == 0:
        user = next((entry.pw_name for entry in pwd.getpwall() if entry.pw_name == "postgres"), None)
        if user is None:
            pytest.skip("PostgreSQL does not run as root, and this machine has no user postgres")
    folder = Path(tempfile.mkdtemp(prefix="labsid-postgres-"))  # a socket's path must be short
    if user is not None:
        shutil.chown(folder, user)
    server = Server(folder, user)
    try:
        server.run("initdb", "-D", f"{folder}/data", "-U", "labsid", "-A", "trust", "-E", "UTF8", "--no-sync")
        server.control("-o", f"-k {folder} -c listen_addresses='' -F", "start")
        yield server
        server.control("-m", "immediate", "stop")
    finally:
        shutil.rmtree(folder)


@pytest.fixture(scope="module", autouse=True)
def unchanged_code() -> Iterator[None]:
    """Somebody may be editing the code while these tests run; a change would have everything graded anew."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("autograder.batch.fingerprint.sources_hash", lambda *modules: "the same")
        yield


def out_folder(folder: Path, url: str = "") -> Path:
    """An OUT folder whose gradebook is where its nbgrader_config.py says, or the file that it is by itself."""
    folder.mkdir()
    if url:
        text = f"c = get_config()\nc.CourseDirectory.db_url = {url!r}\n"
        (folder / "nbgrader_config.py").write_text(text, encoding="utf-8")
    return folder


@dataclass(frozen=True)
class Both:
    """One class graded into a file and into PostgreSQL."""

    course: Course
    submitted: Path
    file: Path
    database: Path

    def grade(self, launcher: ProcessLauncher, out: Path) -> list[tuple[str, str]]:
        """Grade into one of them; which submissions were graded anew."""
        batch = find_batch(self.course, self.submitted)
        done = grade_batch(self.course, batch, out, LocalExecutor(launcher, 2))
        return sorted((one.student, one.assignment) for one in done if one.fresh)

    def texts(self, name: str) -> list[list[str]]:
        """A file of both, but for the seconds and for where it lies."""
        return [
            [re.sub(r",\d+\.\d{3}$", "", line) for line in (out / name).read_text(encoding="utf-8").splitlines()]
            for out in (self.file, self.database)
        ]


def add_a_cell(path: Path) -> None:
    notebook = json.loads(path.read_text(encoding="utf-8"))
    notebook["cells"].append({"cell_type": "markdown", "metadata": {}, "source": "Done."})
    path.write_text(json.dumps(notebook), encoding="utf-8")


@pytest.fixture(scope="module")
def both(course: Course, launcher: ProcessLauncher, server: Server, tmp_path_factory: pytest.TempPathFactory) -> Both:
    """The class as it was graded first, to be read only.

    Ada's pre-lab is right, ben's lab half right, finn's file is cut off, gil's pre-lab a remark.
    """
    folder = tmp_path_factory.mktemp("both")
    write_samples(course, folder / "samples")
    for student, name in (("ada", PRELAB), ("ben", LAB), ("finn", LAB)):
        shutil.copytree(folder / "samples" / student / name, folder / "submitted" / student / name)
    shutil.copytree(course.release / PRELAB, folder / "submitted" / "gil" / PRELAB)
    add_a_cell(folder / "submitted" / "gil" / PRELAB / f"{PRELAB}.ipynb")
    file, database = out_folder(folder / "file"), out_folder(folder / "database", server.database("both"))
    made = Both(course, folder / "submitted", file, database)
    assert len(made.grade(launcher, file)) == len(made.grade(launcher, database)) == 8
    return made


@pytest.fixture
def again(both: Both, launcher: ProcessLauncher, server: Server, tmp_path: Path) -> Both:
    """The same class, to change: the results are copied, and entered into a database of its own."""
    for folder in (both.submitted, both.file):
        shutil.copytree(folder, tmp_path / folder.name)
    database = out_folder(tmp_path / "database", server.database("again"))
    shutil.copytree(both.database / "results", database / "results")
    copied = Both(both.course, tmp_path / "submitted", tmp_path / "file", database)
    assert copied.grade(launcher, database) == []
    assert scores_in_gradebook(database) == scores_in_gradebook(both.file)
    return copied


def test_the_gradebook_is_the_same(both: Both, launcher: ProcessLauncher) -> None:
    scores = scores_in_gradebook(both.database)
    assert len(scores) > 20
    assert scores == scores_in_gradebook(both.file)
    assert not (both.database / "gradebook.db").exists()
    one, other = both.texts("grades.csv")
    assert one == other
    assert both.grade(launcher, both.database) == []
    assert scores_in_gradebook(both.database) == scores


def test_what_formgrader_lists_is_the_same(both: Both) -> None:
    """nbgrader's own queries, which ask the database for sums and averages."""
    file, database = (lists_of_formgrader(out) for out in (both.file, both.database))
    assert file == database
    assert {(row.get("student"), row.get("score")) for row in database} >= {("ada", 0.95), ("gil", 0.0)}


def lists_of_formgrader(out: Path) -> list[dict[str, Any]]:
    with open_gradebook(gradebook.database_url(out)) as book:
        rows = [*book.student_dicts(), *book.submission_dicts(PRELAB), *book.notebook_submission_dicts(PRELAB, PRELAB)]
        rows += [{"mean": book.average_assignment_score(name)} for name in (PRELAB, LAB)]
    plain = [
        {key: round(value, 9) if isinstance(value, float) else value for key, value in row.items() if key != "id"}
        for row in rows
    ]
    return sorted(plain, key=str)


def test_what_was_given_by_hand_outlives_a_new_grading(again: Both, launcher: ProcessLauncher) -> None:
    path = again.submitted / "ada" / PRELAB / f"{PRELAB}.ipynb"
    add_a_cell(path)
    (again.submitted / "gil" / PRELAB / f"{PRELAB}.ipynb").write_text("{", encoding="utf-8")
    for out in (again.file, again.database):
        give_by_hand(out, PRELAB, "ada", OPEN, "Nearly: “see” 3a.", manual_score=0.04)
        give_by_hand(out, PRELAB, "ada", "prelab-1-time", extra_credit=0.2)
        assert again.grade(launcher, out) == [("ada", PRELAB), ("gil", PRELAB)]
        assert main(["course", "export", "--out", str(out)]) == 0
    assert scores_in_gradebook(again.database) == scores_in_gradebook(again.file)
    given = gradebook.read_manual_grades(again.database)
    assert given == gradebook.read_manual_grades(again.file)
    assert given.scores == {("ada", PRELAB, OPEN): Decimal("0.04"), ("ada", PRELAB, "prelab-1-time"): Decimal("0.3")}
    assert given.comments == {("ada", PRELAB, OPEN): "Nearly: “see” 3a."}
    for name in ("grades.csv", "export.csv"):
        one, other = again.texts(name)
        assert one == other
    assert f"ada,{PRELAB},1.19,1,0,complete,0" in again.texts("export.csv")[1]


def test_a_run_that_is_killed_while_entering_enters_nothing(
    both: Both, server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stored = result_files.load_all(both.file)
    out = out_folder(tmp_path / "other", server.database("other"))
    gradebook.prepare(both.course, out, [PRELAB, LAB])

    class Killed(BaseException):
        pass

    def killed(entry: Any, write: Callable[[Any], None] = BulkEntry.flush) -> None:
        write(entry)
        raise Killed

    with monkeypatch.context() as patch:
        patch.setattr(BulkEntry, "flush", killed)
        with pytest.raises(Killed):
            gradebook.enter(out, stored)
    assert scores_in_gradebook(out) == {}
    assert gradebook.enter(out, stored) == 8
    assert scores_in_gradebook(out) == scores_in_gradebook(both.file)
    assert gradebook.enter(out, stored) == 0


def test_a_database_that_is_not_there_is_said(
    both: Both, server: Server, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for number, (url, said) in enumerate(
        (
            (f"postgresql+psycopg://labsid:hush@/nosuch?host={server.folder}", 'database "nosuch" does not exist'),
            (f"postgresql+psycopg://labsid:hush@/x?host={tmp_path}", "No such file or directory"),
            ("postgresql+nosuch://labsid:hush@/x", "Can't load plugin"),
            ("labsid", "is not a database URL"),
        )
    ):
        out = out_folder(tmp_path / str(number), url)
        shutil.copytree(both.file / "results", out / "results")
        assert main(["course", "export", "--out", str(out)]) == 2
        error = capsys.readouterr().err
        assert said in error
        assert "CourseDirectory.db_url" in error
        assert error.count("\n") == 1
        assert "hush" not in error


def test_a_missing_driver_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "psycopg", None)
    out = out_folder(tmp_path / "out", "postgresql+psycopg://labsid@/x")
    with pytest.raises(ValueError, match=r"needs the package psycopg. Install it: pip install 'labsid\[postgres\]'"):
        gradebook.read_manual_grades(out)
