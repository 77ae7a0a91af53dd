"""``labsid course grade --scheduler``: a real scheduler and workers on loopback, and what may go wrong with them."""

import _thread
import contextlib
import pickle
import re
import shutil
import socket
import threading
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import nbformat
import pytest
from dask_machines import Machines, machines_in, wait_for

import autograder
import labsid
from autograder.batch import cluster, cluster_worker
from autograder.batch.cluster import open_cluster
from autograder.batch.executors import LocalExecutor
from autograder.batch.grade import Graded, grade_batch
from autograder.batch.grading_inputs import DataStore, inputs_for
from autograder.batch.selection import Batch, find_batch
from autograder.course.layout import Course, read_template
from autograder.course.sources import sources_hash
from autograder.results import result_files
from autograder.sandbox.isolation import LEVELS, Limits, open_launcher
from autograder.sandbox.student_process import StudentProcessError
from labsid.checks.question import Origin
from labsid.cli.commands import main

PRELAB = "prelab-sinusoids"
SECRET = b"sixteen bytes, and a secret of the course"
LIMITS = Limits(cell_seconds=2)
CHANGED = {
    "loops": {"prelab-4-matrix-answer": "import time\nwhile True:\n    time.sleep(9)"},
    "exits": {"prelab-2-noise-answer": "import os\nos._exit(3)"},
    "wrong": {"prelab-3-cut-answer": "y1 = y2 = 0"},
}
RIGHT = ("ann", "bea", "cal", "dev", "eli")


def before_each_call(folder: Path, statement: str) -> str:
    """Path of a worker's preload that executes a statement whenever the worker is about to judge `task`."""
    path = folder / "preload.py"
    path.write_text(
        "import os, signal, time\n"
        "from autograder.batch.judge_process import JudgeProcess\n"
        "def dask_setup(worker):\n"  # once; Dask executes the file itself twice
        "    call = JudgeProcess.call\n"
        "    def call_after(self, function, task, **options):\n"
        f"        {statement}\n"
        "        return call(self, function, task, **options)\n"
        "    JudgeProcess.call = call_after\n",
        encoding="utf-8",
    )
    return str(path)


@pytest.fixture
def machines(tmp_path: Path) -> Iterator[Machines]:
    with machines_in(tmp_path / "machines") as running:
        yield running


@pytest.fixture(scope="module", autouse=True)
def unchanged_code() -> Iterator[None]:
    """Somebody may be editing the code while these tests run; a change would have everything graded anew."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("autograder.batch.fingerprint.sources_hash", lambda *modules: "the same")
        yield


@pytest.fixture(autouse=True)
def sources_as_they_are() -> None:
    """The fingerprint that workers are held to: of now, for the same reason."""
    sources_hash.cache_clear()


@pytest.fixture(scope="module")
def batch(course: Course, tmp_path_factory: pytest.TempPathFactory) -> Batch:
    """Five who are right, one whose file is cut off, one who loops for ever, one who exits, one who is wrong."""
    submitted = tmp_path_factory.mktemp("class")
    for student in RIGHT:
        write_hand_in(course, submitted, student, {})
    for student, changed in CHANGED.items():
        write_hand_in(course, submitted, student, changed)
    cut = write_hand_in(course, submitted, "cut", {})
    cut.write_bytes(cut.read_bytes()[:1000])
    return find_batch(course, submitted, PRELAB)


def write_hand_in(course: Course, submitted: Path, student: str, changed: Mapping[str, str]) -> Path:
    notebook = nbformat.read(course.source / PRELAB / f"{PRELAB}.ipynb", as_version=4)
    for cell in notebook.cells:
        cell.source = changed.get(cell.id, cell.source)
    path = submitted / student / PRELAB / f"{PRELAB}.ipynb"
    path.parent.mkdir(parents=True)
    nbformat.write(notebook, path)
    return path


@pytest.fixture(scope="module")
def local(course: Course, batch: Batch, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same class, graded on this machine."""
    out = tmp_path_factory.mktemp("local")
    with open_launcher(limits=LIMITS) as launcher:
        list(grade_batch(course, batch, out, LocalExecutor(launcher, 2), SECRET))
    return out


def rows(out: Path, *students: str) -> list[list[str]]:
    """The lines of grades.csv but for the seconds, which come last."""
    lines = [line.rsplit(",", 1)[0] for line in (out / "grades.csv").read_text(encoding="utf-8").splitlines()]
    return [line for line in lines if not students or line.split(",")[0] in students]


def grade(course: Course, batch: Batch, out: Path, machines: Machines, told: list[str]) -> Iterator[Graded]:
    with open_cluster(machines.address, "best", told.append, LIMITS) as executor:
        yield from grade_batch(course, batch, out, executor, SECRET)


def test_a_worker_killed_half_way_costs_nothing_and_without_workers_the_run_ends(
    course: Course, batch: Batch, local: Path, machines: Machines, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    machines.start(workers=2)
    told: list[str] = []
    run = grade(course, batch, tmp_path / "out", machines, told)
    first = [next(run), next(run)]
    machines.workers[0].kill()
    assert len(first + list(run)) == len(batch.students)
    assert told == []
    assert rows(tmp_path / "out") == rows(local)
    assert {one.isolation for one in result_files.load_all(tmp_path / "out")} == {
        one.isolation for one in result_files.load_all(local)
    }
    again = list(grade(course, batch, tmp_path / "out", machines, told))
    assert len(again) == len(batch.students)
    assert not any(one.fresh for one in again)

    monkeypatch.setattr(cluster, "NO_WORKER_SECONDS", 0.5)
    monkeypatch.setattr(cluster, "_POLL_SECONDS", 0.2)
    run = grade(course, batch, tmp_path / "other", machines, told)
    next(run)
    machines.workers[1].kill()
    with pytest.raises(ValueError, match=r"no usable worker is left at tcp://.*run the same command again"):
        list(run)
    assert b"Starting established connection" in machines.said()
    assert SECRET not in machines.said()


def test_a_submission_that_ends_its_workers_costs_only_itself(
    course: Course, batch: Batch, local: Path, machines: Machines, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    preload = before_each_call(tmp_path, "if task.submission.student == 'bea': os.kill(os.getpid(), signal.SIGKILL)")
    machines.start(allowed_failures=0)
    for _ in range(3):
        machines.add_worker("--preload", preload)
    one = replace(batch, students=("bea",))
    told: list[str] = []
    with monkeypatch.context() as patch:
        patch.setattr(cluster, "is_weaker", lambda level, wanted: True)
        list(grade(course, one, tmp_path / "out", machines, told))
    (line,) = told
    assert line.startswith(
        "prelab-sinusoids of bea: quarantined; on the cluster, it killed 1 workers; on this machine, "
    )
    assert "it isolates less than the workers" in line
    assert {row.split(",")[5] for row in rows(tmp_path / "out")[1:]} == {"quarantined"}

    few = replace(batch, students=("ann", "bea", "cut"))
    done = list(grade(course, few, tmp_path / "out", machines, told))
    assert Graded("bea", PRELAB, True, "environment") in done
    assert "prelab-sinusoids of bea: graded on this machine; on the cluster, it killed 1 workers" in told
    assert rows(tmp_path / "out") == rows(local, "student", *few.students)


@pytest.mark.exhaustive  # below, a worker is asked what it is refused for
def test_a_worker_with_another_labsid_is_refused(
    course: Course,
    batch: Batch,
    local: Path,
    machines: Machines,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """One that joins later, too; and where there is no other one, nothing is graded."""
    other = tmp_path / "other"
    for package in (labsid, autograder):
        source = Path(str(package.__file__)).parent
        shutil.copytree(source, other / source.name, ignore=shutil.ignore_patterns("__pycache__", "release", "source"))
    with (other / "labsid" / "lab" / "sinusoid.py").open("a", encoding="utf-8") as file:
        file.write("# another version\n")
    machines.start(workers=1)
    told: list[str] = []
    few = replace(batch, students=RIGHT)
    with monkeypatch.context() as patch:
        patch.undo()
        with open_cluster(machines.address, "best", told.append, LIMITS) as executor:
            machines.add_worker(PYTHONPATH=str(other))
            executor._client.wait_for_workers(2, timeout=60)
            list(grade_batch(course, few, tmp_path / "out", executor, SECRET))
    (line,) = told
    assert "is rejected: its labsid has other sources than this machine's" in line
    assert rows(tmp_path / "out") == rows(local, "student", *RIGHT)

    machines.workers[0].kill()
    machines.workers[0].wait()
    monkeypatch.setattr("autograder.course.layout.find_course", lambda: course)
    arguments = ["--submitted", str(batch.submitted), "--out", str(tmp_path / "none")]
    assert main(["course", "grade", *arguments, "--scheduler", machines.address]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert f"no worker of {machines.address} is usable" in line
    assert "its labsid has other sources" in line
    assert not list((tmp_path / "none").glob("results/*"))


@pytest.mark.exhaustive  # `test_cli.py` stops a run by Ctrl-C; above, all workers are gone
def test_stopped_by_ctrl_c_and_by_a_scheduler_that_dies_a_run_goes_on(
    course: Course,
    batch: Batch,
    local: Path,
    machines: Machines,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    machines.start().add_worker("--preload", before_each_call(tmp_path, "time.sleep(0.3)"))
    assert machines.scheduler is not None
    monkeypatch.setattr("autograder.course.layout.find_course", lambda: course)
    shutil.copytree(batch.submitted, tmp_path / "submitted", ignore=shutil.ignore_patterns(*CHANGED))
    (tmp_path / "secret").write_bytes(SECRET)
    out = tmp_path / "out"
    command = ["course", "grade", "--submitted", str(tmp_path / "submitted"), "--out", str(out)]
    command += ["--secret", str(tmp_path / "secret")]

    def graded() -> set[Path]:
        return set(out.glob("results/*/*.json"))

    def grade_until(there: int, stop: Callable[[], None]) -> str:
        def watch() -> None:
            wait_for(lambda: len(graded()) >= there)
            stop()

        watcher = threading.Thread(target=watch)
        watcher.start()
        assert main([*command, "--scheduler", machines.address]) == 2
        watcher.join()
        (line,) = capsys.readouterr().err.splitlines()
        return line

    assert "interrupted. Finished results are kept" in grade_until(2, _thread.interrupt_main)
    kept = graded()
    assert 2 <= len(kept) < 6
    assert f"the scheduler at {machines.address} is gone" in grade_until(len(kept) + 1, machines.scheduler.kill)
    assert kept < graded()
    assert not (out / "grades.csv").exists()
    kept = graded()
    assert main(command) == 0
    assert f"{6 - len(kept)} submissions graded, {len(kept)} unchanged" in capsys.readouterr().out
    assert rows(out) == rows(local, "student", "cut", *RIGHT)


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("nonsense", "--scheduler: got 'nonsense', expected an address such as tcp://HOST:8786"),
        ("http://127.0.0.1:8786", "--scheduler: got 'http://127.0.0.1:8786', expected"),
        ("tcp://127.0.0.1:99999", "--scheduler: got 'tcp://127.0.0.1:99999', expected"),
        ("127.0.0.1:{closed}", "no Dask scheduler answers at tcp://127.0.0.1:"),
        ("tcp://127.0.0.1:{silent}", "no Dask scheduler answers at tcp://127.0.0.1:"),
    ],
)
def test_a_wrong_address_is_said_in_one_line(
    course: Course,
    batch: Batch,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    address: str,
    said: str,
) -> None:
    monkeypatch.setattr("autograder.course.layout.find_course", lambda: course)
    monkeypatch.setattr(cluster, "CONNECT_SECONDS", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as silent, socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        address = address.format(silent=silent.getsockname()[1], closed=closed.getsockname()[1])
        arguments = ["--submitted", str(batch.submitted), "--out", str(tmp_path)]
        assert main(["course", "grade", *arguments, "--scheduler", address]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


def test_a_scheduler_without_workers_is_not_waited_for(machines: Machines, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "NO_WORKER_SECONDS", 1.0)
    machines.start()
    with (
        pytest.raises(ValueError, match=r"has no worker\. Start some: dask worker tcp://"),
        open_cluster(machines.address, "best", print),
    ):
        pass


@pytest.fixture
def fresh_worker(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """This process as a worker that has no launcher yet."""
    with contextlib.ExitStack() as opened:
        monkeypatch.setattr(cluster_worker, "_LAUNCHERS", {})
        monkeypatch.setattr(cluster_worker, "_TO_CLOSE", opened)
        yield


@pytest.mark.usefixtures("fresh_worker")
def test_what_a_worker_is_refused_for(monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = cluster_worker.worker_requirements("best", LIMITS)

    def refused(**other: object) -> str:
        answer = cluster_worker.check_worker(replace(wanted, **other))  # type: ignore[arg-type]
        assert isinstance(answer, cluster_worker.Failure)
        return answer.reason

    assert "other sources" in refused(sources="others")
    there = tuple("numpy=0.1" if one.startswith("numpy=") else one for one in wanted.environment)
    assert re.match(r"it has numpy=\S+ instead of numpy=0.1: install", refused(environment=there))
    with monkeypatch.context() as patch:
        patch.setattr("autograder.sandbox.isolation._open_strongest", lambda wanted, limits: (None, []))
        assert "isolation 'strict' is unavailable" in refused(isolation="strict")
    with monkeypatch.context() as patch:
        patch.setattr(cluster_worker, "is_blocked", lambda launcher, escape: False)
        assert "student code on it could connect to the scheduler" in refused()
        assert cluster_worker.check_worker(replace(wanted, isolation="none")) == "none"
    assert cluster_worker.check_worker(wanted) in LEVELS


def test_what_goes_over_the_wire_comes_out_the_same(course: Course, tmp_path: Path) -> None:
    for name in course.assignments():
        assets = inputs_for(DataStore(course, SECRET, tmp_path), read_template(course, name), "ann").assets
        sent = pickle.loads(pickle.dumps(assets))
        assert (sent.template, sent.assignment, sent.origin) == (assets.template, assets.assignment, assets.origin)
        assert sent.secret == SECRET
        assert "secret" not in repr(assets)
    assert "secret" not in repr(Origin("ann", SECRET))
    died = pickle.loads(pickle.dumps(StudentProcessError("limit", "it took too long")))
    assert (type(died), died.status, str(died)) == (StudentProcessError, "limit", "it took too long")
