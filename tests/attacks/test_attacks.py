"""Every attack, graded in one batch beside two honest students: on the best rung of this machine, and on the last.

Loopback only. What attacks leave running is ended by the grader, which is what is tested.
"""

import base64
import contextlib
import hashlib
import hmac
import html
import json
import os
import re
import shutil
import socket
import sqlite3
import stat
import tempfile
import zipfile
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

import nbformat
import numpy as np
import pytest

from attacks import FUNCTION, NOISE, QUESTIONS, Attack, answers, hand_ins, processes, reach
from autograder import results
from autograder.bench import remove
from autograder.build import build_course
from autograder.collect import collect
from autograder.course import Course, read_template
from autograder.feedback import write_feedback
from autograder.grade import Batch, find_batch, grade_batch
from autograder.isolation import Limits, StudentDied, open_workshop
from autograder.results import StoredResult
from labsid.checks.assignments.prelab_sinusoids import function
from labsid.sinusoid import make_sinusoids

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")

ROOT = Path(__file__).resolve().parent.parent.parent
NAME = "prelab-sinusoids"
ATTACKS: tuple[Attack, ...] = (*processes.ATTACKS, *answers.ATTACKS, *reach.ATTACKS, *hand_ins.ATTACKS)
HONEST = ("honest-ada", "honest-ben")
SECRET = b"the secret of this course"
LIMITS = Limits(
    cell_seconds=3,
    call_seconds=3,
    submission_seconds=9,
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

    rung: str
    out: Path
    results: dict[str, StoredResult]
    pages: dict[str, str]
    alone: dict[str, StoredResult]
    untouched: dict[str, bool]
    left_running: list[str]
    left_behind: list[str]


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    """A course of one assignment."""
    root = tmp_path_factory.mktemp("course")
    shutil.copytree(ROOT / "notebooks" / NAME, root / "notebooks" / NAME)
    (root / "data").mkdir()
    (root / "autograder").mkdir()
    built = Course(root)
    assert list(build_course(built)) == [NAME]
    return built


@pytest.fixture(scope="module")
def outcomes() -> dict[str, Outcome]:
    """Each rung's batch, graded when it is first asked for."""
    return {}


@pytest.fixture(params=["best", "none"])
def outcome(
    request: pytest.FixtureRequest, course: Course, outcomes: dict[str, Outcome], tmp_path_factory: Any
) -> Outcome:
    """The batch as it was graded on the best rung, and on the last."""
    wanted = request.param
    if wanted not in outcomes:
        outcomes[wanted] = graded(course, tmp_path_factory.mktemp(wanted), wanted)
    if wanted == "best" and outcomes[wanted].rung == "none":
        pytest.skip("this machine has no isolation: the last rung is the best")
    return outcomes[wanted]


def graded(course: Course, folder: Path, isolation: str) -> Outcome:
    submitted, earlier = folder / "submitted", folder / "earlier"
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
    with socket.create_server(("127.0.0.1", 0)) as listener, pytest.MonkeyPatch.context() as patch:
        patch.setattr("autograder.fingerprint.sources_hash", lambda *modules: "the same")
        listener.setblocking(False)
        with open_workshop(isolation, LIMITS) as workshop:
            alone = run(course, find_batch(course, submitted, NAME), folder / "alone", workshop)
            here = {
                "grader": os.getpid(),
                "parent": getattr(workshop, "parent", 0),
                "secret": SECRET.decode(),
                "solution": str(course.source / NAME / f"{NAME}.ipynb"),
                "other": str(submitted / HONEST[0] / NAME / f"{NAME}.ipynb"),
                "gradebook": str(earlier / "gradebook.db"),
                "shared": "/dev/shm" if os.path.isdir("/dev/shm") else "/tmp",
                "port": listener.getsockname()[1],
            }
            for attack in ATTACKS:
                lay_out(attack, submitted / student_of(attack) / NAME, notebook, here)
            before = {place: digest(place) for place in (course.root, submitted, earlier, folder / "alone")}
            batch = find_batch(course, submitted, NAME)
            found = run(course, batch, folder / "out", workshop, jobs=6)
            rung = workshop.rung
        try:
            listener.accept()[0].close()
            asked = True
        except BlockingIOError:
            asked = False
    left = Path(here["shared"], "labsid-attack")
    untouched = {
        "course": before[course.root] == digest(course.root),
        "hand-ins": before[submitted] == digest(submitted),
        "gradebook": before[earlier] == digest(earlier),
        "grades": before[folder / "alone"] == digest(folder / "alone"),
        "left": not left.exists(),
        "listener": not asked,
    }
    left.unlink(missing_ok=True)
    benches = sorted(path.name for path in Path(tempfile.gettempdir()).glob(f"labsid-bench-{os.getpid()}-*"))
    pages = {path.parent.name: path.read_text(encoding="utf-8") for path in write_feedback(folder / "out")}
    return Outcome(rung, folder / "out", found, pages, alone, untouched, running("labsid-attack"), benches)


def run(course: Course, batch: Batch, out: Path, workshop: Any, jobs: int = 1) -> dict[str, StoredResult]:
    done = list(grade_batch(course, batch, out, workshop, jobs, SECRET))
    assert sorted(one.student for one in done) == sorted(batch.students)
    return {one.student: one for one in results.load_all(out)}


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
            cells.append({"cell_type": "code", "metadata": {}, "source": code, "outputs": [], "execution_count": None})
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
        if stat.S_ISREG(kind):
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


@pytest.mark.parametrize("attack", ATTACKS, ids=lambda attack: attack.name)
def test_an_attack_earns_what_it_should(
    attack: Attack, outcome: Outcome, course: Course, request: pytest.FixtureRequest
) -> None:
    if outcome.rung == "none" and attack.open_on_none:
        request.applymarker(pytest.mark.xfail(strict=True, reason=attack.open_on_none))
    result = outcome.results[student_of(attack)]
    worth = {cell.id: cell.points for cell in read_template(course, NAME).questions}
    scores = {one.question: one.score for one in result.questions if one.question in QUESTIONS}
    expected = {question: Decimal(0) if question in attack.loses else worth[question] for question in QUESTIONS}
    reasons = {one.question: one.reason for one in result.questions}
    if attack.hurts_itself:
        assert all(score <= expected[question] for question, score in scores.items()), reasons
    else:
        assert scores == expected, reasons
    if attack.said:
        assert re.search(attack.said, reasons[attack.loses[0]]), reasons[attack.loses[0]]
    if attack.spares:
        assert outcome.untouched[attack.spares]


def test_attacks_have_names_of_their_own() -> None:
    assert len({student_of(attack) for attack in ATTACKS}) == len(ATTACKS)
    assert all(set(attack.loses) <= set(QUESTIONS) and attack.why for attack in ATTACKS)


def test_honest_students_get_what_they_get_without_attackers(outcome: Outcome) -> None:
    for student in HONEST:
        assert as_graded(outcome.results[student]) == as_graded(outcome.alone[student])
    ada, ben = (outcome.results[student].questions for student in HONEST)
    assert all(one.score == one.max_score for one in ada if one.question in QUESTIONS)
    assert [one.question for one in ben if one.score == 0] == ["prelab-3-cut"]


def as_graded(result: StoredResult) -> list[tuple[Any, ...]]:
    return [(one.question, one.score, one.status, one.reason, one.output, one.figures) for one in result.questions]


def test_nothing_else_is_touched(outcome: Outcome) -> None:
    kept = {"course", "hand-ins", "grades"} | ({"gradebook", "left"} if outcome.rung != "none" else set())
    assert [place for place in sorted(kept) if not outcome.untouched[place]] == []


def test_nothing_is_left(outcome: Outcome) -> None:
    assert outcome.left_running == []
    assert outcome.left_behind == []


def test_pages_run_nothing(outcome: Outcome) -> None:
    for student, page in outcome.pages.items():
        shown = [base64.b64decode(picture).decode() for picture in re.findall(r"base64,([\w+/=]+)", page)]
        for text in (page, *shown):
            assert not re.search(r"<script|<img(?! alt=\"Your figure)|<iframe|\x1b|javascript:", text), student
            assert not re.search(r"<[^>]*\son\w+\s*=", text), student
    planted = outcome.pages["HTML-and-colours-in-output-and-error"]
    assert html.escape(hand_ins.SCRIPT, quote=False).replace("'", "&#39;") in planted


def test_pages_hold_no_hidden_input(outcome: Outcome) -> None:
    for student, page in outcome.pages.items():
        numbers = {repr(abs(value))[:8] for array in hidden_inputs(student) for value in array.ravel().tolist()}
        telling = [number for number in numbers if len(number) == 8 and len(set(number[-4:])) > 1]
        assert len(telling) > 100
        assert [number for number in telling if number in page] == [], student


def rng_of(student: str, question: str) -> np.random.Generator:
    """As the judge seeds it."""
    seed = hmac.new(SECRET, f"{student}\0{NAME}\0{question}".encode(), hashlib.sha256).digest()
    return np.random.default_rng(list(seed))


def hidden_inputs(student: str) -> list[np.ndarray]:
    """What the judge tries this student's function on."""
    tried: list[np.ndarray] = []

    class Asked:
        rng = rng_of(student, FUNCTION)

        def call(self, name: str, data: np.ndarray, n: int) -> np.ndarray:
            tried.append(data)
            right = data[n:].copy()
            right[:, 0] -= right[0, 0]
            return right

    assert function(Asked()).passed  # type: ignore[arg-type]
    return tried


def test_pages_hold_no_right_value_of_a_failed_step(outcome: Outcome) -> None:
    student = "right-values-of-a-failed-step-printed"
    printed = html.unescape(outcome.pages[student])
    assert [value for value in _right_noise(student) if repr(value) in printed] == []


def _right_noise(student: str) -> list[float]:
    found: list[float] = make_sinusoids(rng_of(student, NOISE)).y1.ravel().tolist()
    return found[:50]


@pytest.mark.xfail(
    strict=True,
    reason="a snapshot has the work folder, and memory that was shared before, in common with the process it is of",
)
def test_what_a_snapshot_saw_stays_there(tmp_path: Path) -> None:
    """Functions of questions that later steps start from are called in a snapshot, and later cells are printed."""
    with open_workshop("best", LIMITS) as workshop:
        student = workshop.start(tmp_path)
        try:
            student.run("def f(x):\n    open('kept', 'w').write(str(x))\n    return x")
            snapshot = student.snapshot()
            assert snapshot is not None
            snapshot.call("f", 1234.5)
            snapshot.close()
            seen = student.run("print(open('kept').read())").stdout
        finally:
            student.close()
    assert "1234.5" not in seen


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root gives files away")
@pytest.mark.parametrize("kind", ["a link in its place", "a hard link in it"])
def test_a_work_folder_that_leads_elsewhere_gives_nothing_away(tmp_path: Path, kind: str) -> None:
    """A process that takes the place of one that died becomes the owner of the work folder, and of nothing else."""
    other = tmp_path / "other"
    other.mkdir()
    (other / "gradebook.db").write_text("0.5", encoding="utf-8")
    folder = tmp_path / "bench"
    if kind == "a link in its place":
        folder.symlink_to(other)
    else:
        folder.mkdir()
        os.link(other / "gradebook.db", folder / "mine")
    tmp_path.chmod(0o755)
    with open_workshop("none", LIMITS) as workshop, contextlib.suppress(StudentDied):
        workshop.start(folder).close()
    remove(folder)
    assert {path.stat().st_uid for path in (other, other / "gradebook.db")} == {0}
    assert not folder.exists()


def test_a_zip_bomb_costs_nobody_else_their_hand_in(course: Course, tmp_path: Path) -> None:
    release = (course.release / NAME / f"{NAME}.ipynb").read_bytes()
    bomb = tmp_path / "bomb.zip"
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        for index in range(3):
            archive.writestr(f"{index}.ipynb", bytes(60 << 20), compresslevel=1)
    with zipfile.ZipFile(tmp_path / "moodle.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(f"Ada_1_assignsubmission_file_/{NAME}.ipynb", release)
        archive.write(bomb, "Mallory_2_assignsubmission_file_/bomb.zip")
        archive.write(bomb, "Mallory_2_assignsubmission_file_/bomb2.zip")
        archive.writestr("Mallory_2_assignsubmission_file_/../../../out.ipynb", release)
        archive.writestr(f"Eve_3_assignsubmission_file_/{NAME}.ipynb", release)
    list(collect(course, tmp_path / "moodle.zip", tmp_path / "submitted"))
    taken = {path.relative_to(tmp_path / "submitted") for path in (tmp_path / "submitted").rglob("*.ipynb")}
    assert {Path("1", NAME, f"{NAME}.ipynb"), Path("3", NAME, f"{NAME}.ipynb")} <= taken
    assert all(path.parts[0] in ("1", "2", "3") for path in taken)
    assert sum(path.stat().st_size for path in (tmp_path / "submitted").rglob("*") if path.is_file()) < 60 << 20
