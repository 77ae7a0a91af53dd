"""A notebook in two processes: one for its cells, another for calls on hidden inputs while cells are to come."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from autograder.intake.submission import NotebookCell
from autograder.judge.execution import Execution
from autograder.sandbox.isolation import (
    LEVELS,
    IsolationError,
    Limits,
    MachineError,
    ProcessLauncher,
    StudentProcessError,
    open_launcher,
)
from autograder.sandbox.process_launchers import SpawningLauncher

LIMITS = Limits(cell_seconds=20, call_seconds=20)


@pytest.fixture(scope="module", params=[*LEVELS, "spawned"])
def launcher(request: pytest.FixtureRequest) -> Iterator[ProcessLauncher]:
    """Every way to start a student's process; what this machine does not have is skipped, saying why."""
    if request.param == "spawned":
        yield SpawningLauncher(LIMITS)
        return
    if not hasattr(os, "fork"):
        pytest.skip("this system cannot fork")
    try:
        with open_launcher(request.param, LIMITS) as opened:
            yield opened
    except IsolationError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="module")
def forked() -> Iterator[ProcessLauncher]:
    with open_launcher("none", LIMITS) as opened:
        yield opened


def cell(source: str) -> NotebookCell:
    return NotebookCell(None, "extra", source, True)


@contextlib.contextmanager
def running(launcher: ProcessLauncher, folder: Path, *cells: str) -> Iterator[Execution]:
    started = Execution(launcher, folder)
    try:
        for source in cells:
            assert started.run(cell(source)).reply.ok
        yield started
    finally:
        started.close()


KEEPS = """
import mmap, os
kept, shared, (reader, writer) = [], mmap.mmap(-1, 4), os.pipe()
os.set_blocking(reader, False)
def f(x):
    kept.append(x)
    shared[:4] = b"seen"
    os.write(writer, b"seen")
    open("kept", "w").write(str(x))
    return len(kept)
"""
FOUND = """
print(kept, shared[0], os.path.exists("kept"))
try:
    print(os.read(reader, 4))
except BlockingIOError:
    print("nothing")
"""


def test_what_a_function_was_called_on_stays_in_its_process(launcher: ProcessLauncher, tmp_path: Path) -> None:
    with running(launcher, tmp_path, KEEPS) as notebook:
        with notebook.call_process() as other:
            assert other.call("f", 1234.5).value == 1
        assert notebook.run(cell(FOUND)).reply.stdout.splitlines() == ["[] 0 False", "nothing"]


def test_the_other_process_is_where_the_first_one_is(forked: ProcessLauncher, tmp_path: Path) -> None:
    with running(forked, tmp_path, "a = 1\ndef f():\n    return a") as notebook:
        with notebook.call_process() as other:
            assert other.call("f").value == 1
        notebook.run(cell("a += 1"))
        notebook.set({"b": 5.0})
        with notebook.call_process() as again:
            assert again is other
            assert again.call("f").value == 2
            assert again.value("b").value == 5.0


@pytest.mark.parametrize(
    ("start", "call"),
    [
        ("calls = 0", "global calls\n    calls += 1\n    return calls"),
        ("calls = []", "calls.append(1)\n    return len(calls)"),
    ],
)
def test_a_call_changes_nothing_for_the_next(forked: ProcessLauncher, tmp_path: Path, start: str, call: str) -> None:
    with running(forked, tmp_path, f"{start}\ndef f():\n    {call}") as notebook:
        for _ in range(2):
            with notebook.call_process() as other:
                assert other.call("f").value == 1


def test_a_cell_that_killed_the_first_process_is_not_run_in_the_other(forked: ProcessLauncher, tmp_path: Path) -> None:
    with running(forked, tmp_path, "a = 1\ndef f():\n    return a") as notebook:
        with notebook.call_process() as other:
            assert other.call("f").value == 1
        assert notebook.run(cell("import os\na = 2\nos._exit(1)")).failure is not None
        notebook.run(cell("a += 2"))
        with notebook.call_process() as other:
            assert other.call("f").value == 3


def test_a_call_that_ends_the_other_process_is_not_missed(forked: ProcessLauncher, tmp_path: Path) -> None:
    with running(forked, tmp_path, "import os\ndef f():\n    os._exit(3)\ndef g():\n    return 5") as notebook:
        with notebook.call_process() as other, pytest.raises(StudentProcessError, match="ended with exit status 3"):
            other.call("f")
        with notebook.call_process() as other:
            assert other.call("g").value == 5
        assert notebook.process.call("g").value == 5


def test_cells_that_cannot_be_run_twice_are_said(forked: ProcessLauncher, tmp_path: Path) -> None:
    once = "import os\nif os.path.exists('ran'):\n    os._exit(4)"
    with running(forked, tmp_path, once) as notebook:
        (tmp_path / "ran").touch()
        said = "when its cells were run a second time, its process ended with exit status 4"
        with pytest.raises(StudentProcessError, match=said), notebook.call_process():
            pass


def test_running_cells_again_is_not_on_the_notebooks_time(tmp_path: Path) -> None:
    limits = Limits(submission_seconds=4)
    with (
        open_launcher("none", limits) as launcher,
        running(launcher, tmp_path, "import time\ntime.sleep(2.2)") as notebook,
    ):
        with notebook.call_process():
            pass
        assert notebook.run(cell("time.sleep(0.8)")).failure is None


def test_running_cells_again_has_a_limit_too(tmp_path: Path) -> None:
    """A notebook that is slow the second time does not hold the grader up for longer than its limit."""
    slower = "import os, time\nif os.path.exists('ran'):\n    time.sleep(60)"
    limits = Limits(submission_seconds=1.5)
    with open_launcher("none", limits) as launcher, running(launcher, tmp_path, slower) as notebook:
        (tmp_path / "ran").touch()
        with pytest.raises(StudentProcessError, match="took longer than") as died, notebook.call_process():
            pass
    assert died.value.status == "timeout"


def test_a_full_disk_is_a_failure_of_the_machine(
    forked: ProcessLauncher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Unless there is space left, and the student's code has exceeded its own limit or says so itself."""
    said = cell("raise OSError(28, 'No space left on device')")
    with running(forked, tmp_path) as notebook:
        assert (notebook.run(said).reply.error or {})["kind"] == "OSError"
        monkeypatch.setattr("autograder.judge.execution.disk_is_full", lambda: True)
        with pytest.raises(MachineError, match="No space left on device"):
            notebook.run(said)
