"""A notebook in a process that may end, and in another one up to the point where its variables were saved."""

import contextlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from autograder.intake.submission import NotebookCell
from autograder.judge.execution import Execution, source_to_run
from autograder.sandbox.isolation import (
    Limits,
    MachineError,
    ProcessLauncher,
    StudentProcess,
    StudentProcessError,
    open_launcher,
)
from autograder.sandbox.replacing import Replacement

LIMITS = Limits(cell_seconds=20, call_seconds=20)


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


def test_another_process_is_where_the_first_one_was(forked: ProcessLauncher, tmp_path: Path) -> None:
    with running(forked, tmp_path, "a = 1\ndef f():\n    return a") as notebook:
        notebook.replace(Replacement({"b": 5.0}, {}))
        notebook.save_variables(0)
        notebook.run(cell("a += 1\nb = 6"))
        with contextlib.closing(notebook.replayed(0)) as other:
            assert (other.call("f").value, other.value("b").value) == (1, 5.0)
        assert notebook.process.call("f").value == 2


def test_a_cell_that_ended_the_process_is_left_out(forked: ProcessLauncher, tmp_path: Path) -> None:
    with running(forked, tmp_path, "a = 1\ndef f():\n    return a") as notebook:
        notebook.save_variables(0)
        assert notebook.run(cell("import os\na = 2\nos._exit(1)")).failure is not None
        notebook.run(cell("a += 2"))
        assert notebook.process.call("f").value == 3
        assert notebook.process.restore_variables(0) is False
        assert notebook.process.call("f").value == 1


def test_cells_that_cannot_be_run_twice_are_said(forked: ProcessLauncher, tmp_path: Path) -> None:
    once = "import os\nif os.path.exists('ran'):\n    os._exit(4)"
    with running(forked, tmp_path, once) as notebook:
        notebook.save_variables(0)
        (tmp_path / "ran").touch()
        said = "when its cells were run a second time, its process ended with exit status 4"
        with pytest.raises(StudentProcessError, match=said):
            notebook.replayed(0)


def test_what_cannot_be_saved_is_said_where_it_is_missing(
    forked: ProcessLauncher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def too_slow(self: StudentProcess, key: int) -> None:
        raise StudentProcessError("timeout", "it took longer than 10 s")

    with running(forked, tmp_path, "a = 1") as notebook:
        monkeypatch.setattr(StudentProcess, "save_variables", too_slow)
        notebook.save_variables(7)
        with pytest.raises(StudentProcessError, match="its variables could not be saved: it took longer than 10 s"):
            notebook.restore_variables(7)
        with pytest.raises(StudentProcessError, match="the variables at this step could not be restored"):
            notebook.restore_variables(8)
        assert notebook.process.value("a").value == 1
        assert notebook.said_of_left_out() == ""


def test_a_cell_that_is_left_out_the_second_time_is_said(forked: ProcessLauncher, tmp_path: Path) -> None:
    once = "import os\nif os.path.exists('ran'):\n    os._exit(4)\na = 1"
    with running(forked, tmp_path, once) as notebook:
        (tmp_path / "ran").touch()
        notebook.run(cell("os._exit(1)"))
        assert not notebook.process.value("a").ok
        assert "a cell did not finish (its process ended with exit status 4)" in notebook.said_of_left_out()


def test_a_cell_that_has_run_may_take_longer_when_it_runs_again(tmp_path: Path) -> None:
    slower_again = "import os, time\nif os.path.exists('ran'):\n    time.sleep(2)\na = 1"
    with (
        open_launcher("none", Limits(cell_seconds=1.5, call_seconds=20)) as launcher,
        running(launcher, tmp_path, slower_again) as notebook,
    ):
        (tmp_path / "ran").touch()
        assert notebook.run(cell("import time\ntime.sleep(2)")).failure is not None
        assert notebook.process.value("a").value == 1


def test_running_cells_again_is_not_on_the_notebooks_time(tmp_path: Path) -> None:
    limits = Limits(submission_seconds=6)
    with (
        open_launcher("none", limits) as launcher,
        running(launcher, tmp_path, "import time\ntime.sleep(3.1)") as notebook,
    ):
        notebook.save_variables(0)
        notebook.replayed(0).close()
        assert notebook.run(cell("time.sleep(0.1)")).failure is None


def test_running_cells_again_has_a_limit_too(tmp_path: Path) -> None:
    """A notebook that is slow the second time does not hold the grader up for longer than its limit."""
    slower = "import os, time\nif os.path.exists('ran'):\n    time.sleep(60)"
    limits = Limits(submission_seconds=1.5)
    with open_launcher("none", limits) as launcher, running(launcher, tmp_path, slower) as notebook:
        notebook.save_variables(0)
        (tmp_path / "ran").touch()
        with pytest.raises(StudentProcessError, match="took longer than") as died:
            notebook.replayed(0)
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


@pytest.mark.parametrize(
    ("kind", "code", "runs"),
    [
        ("given", True, True),
        ("answer", True, True),
        ("extra", True, True),
        ("extra", False, False),
        ("question", True, False),
        ("manual", False, False),
    ],
)
def test_given_cells_and_answers_are_run(kind: str, code: bool, runs: bool) -> None:
    assert source_to_run(NotebookCell("c", kind, "a = 1", code)) == ("a = 1" if runs else "")


def test_of_a_demonstration_the_definitions_are_run(forked: ProcessLauncher, tmp_path: Path) -> None:
    source = "inv = abs\nprint(1 / 0)\ndef twice(x):\n    return 2 * x"
    with running(forked, tmp_path) as notebook:
        done = notebook.run(NotebookCell("c", "demonstration", source, True))
        assert (done.cell.source, done.reply.ok) == (source, True)
        assert notebook.process.call("twice", 4).value == 8
