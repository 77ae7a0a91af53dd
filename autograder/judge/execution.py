"""Execution of a student's notebook: within its limits, with the state restored when its process ends."""

import errno
import os
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from autograder.course.definitions import definitions_in
from autograder.intake.submission import NotebookCell
from autograder.sandbox.isolation import MachineError, ProcessLauncher, Reply, StudentProcess, StudentProcessError
from autograder.sandbox.workdirs import disk_is_full
from labsid.checks.values import Value

_Action = NotebookCell | Mapping[str, Value] | int
"""A step of a replay: a cell to run, variables to set, or the key to save the variables under."""

_NO_SPACE = os.strerror(errno.ENOSPC)


@dataclass(frozen=True, slots=True)
class ExecutedCell:
    """A cell with its output.

    Attributes
    ----------
    cell : NotebookCell
    reply : Reply
        Empty for a cell that is not executed.
    failure : StudentProcessError or None
        How the process ended while it ran this cell.
    """

    cell: NotebookCell
    reply: Reply
    failure: StudentProcessError | None = None


def source_to_run(cell: NotebookCell) -> str:
    """The code of a cell that is run while grading: of a demonstration its definitions, of a check nothing."""
    if cell.code and cell.kind == "demonstration":
        return definitions_in(cell.source)
    return cell.source if cell.code and cell.kind in ("given", "answer", "extra", "tests") else ""


class Execution:
    """Runs the cells of one submission; a process that ends is replaced by one in the same state.

    Parameters
    ----------
    launcher : ProcessLauncher
    folder : Path
        The files of the student's work folder.
    deadline : float, optional
        End of the submission's time, on the monotonic clock; its limit from now if there is none yet.

    Attributes
    ----------
    process : StudentProcess
        The current process.
    """

    def __init__(self, launcher: ProcessLauncher, folder: Path, deadline: float | None = None) -> None:
        self._launcher = launcher
        self._folder = folder
        self._actions: list[_Action] = []
        self._cells = 0
        self._printed = 0
        self._deadline = time.monotonic() + launcher.limits.submission_seconds if deadline is None else deadline
        self._replay_seconds = launcher.limits.submission_seconds
        self.process = self._start()

    def run(self, cell: NotebookCell) -> ExecutedCell:
        """Run a cell, if it is one to be run; one that ends its process is not replayed in the next process."""
        source = source_to_run(cell)
        if not source:
            return ExecutedCell(cell, Reply(True))
        max_cells = self._launcher.limits.cells
        self._cells += 1
        if self._cells > max_cells:
            failure = StudentProcessError("limit", f"the notebook has more than {max_cells} cells")
            return ExecutedCell(cell, Reply(False), failure)
        try:
            reply = self.process.run(source)
        except StudentProcessError as failure:
            self.restart()
            return ExecutedCell(cell, Reply(False), failure)
        if _NO_SPACE in str((reply.error or {}).get("text")) and disk_is_full():
            raise MachineError(_NO_SPACE)
        self._actions.append(cell)
        return ExecutedCell(cell, self._truncated(reply))

    def set(self, values: Mapping[str, Value]) -> None:
        """Set variables, in this process and in every later one."""
        self._actions.append(values)
        try:
            self.process.set(values)
        except StudentProcessError:
            self.restart()

    def save_variables(self, key: int) -> None:
        """Save the current variables under a key, in this process and in every later one."""
        self._actions.append(key)
        try:
            self.process.save_variables(key)
        except StudentProcessError:
            self.restart()

    def restart(self) -> None:
        """Start another process and replay all actions, without a cell that ends the process."""
        while True:
            self.process.close()
            if time.monotonic() > self._deadline:
                return
            try:
                self.process = self._start()
            except StudentProcessError:  # the next request fails and restarts again
                return
            failed = self._replay(self.process, self._actions)
            if failed is None:
                return
            del self._actions[failed[0]]

    def replayed(self, key: int) -> StudentProcess:
        """Start a process and replay the actions up to the point where the variables were saved under `key`.

        Raises
        ------
        StudentProcessError
            If the process ends during the replay.
        """
        process = self._start()
        try:
            self._timed_replay(process, self._actions[: self._actions.index(key)])
        except BaseException:
            process.close()
            raise
        return process

    def extend_deadline(self, seconds: float) -> None:
        """Extend the deadline, if necessary, so that at least this many seconds remain."""
        self._deadline = self.process.deadline = max(self._deadline, time.monotonic() + seconds)

    def close(self) -> None:
        """End the process."""
        self.process.close()

    def _timed_replay(self, process: StudentProcess, actions: list[_Action]) -> None:
        """Replay on the judge's time: it moves the deadline, and all replays together have a limit of their own."""
        began = time.monotonic()
        process.deadline = began + self._replay_seconds
        failed = self._replay(process, actions)
        elapsed = time.monotonic() - began
        self._replay_seconds -= elapsed
        self._deadline += elapsed
        self.process.deadline = process.deadline = self._deadline
        if failed is not None:
            process.close()
            raise StudentProcessError(failed[1].status, f"when its cells were run a second time, {failed[1]}")

    def _replay(self, process: StudentProcess, actions: list[_Action]) -> tuple[int, StudentProcessError] | None:
        """Replay actions; returns the index and the error of the one that ended the process."""
        for index, action in enumerate(actions):
            try:
                if isinstance(action, NotebookCell):
                    process.run(source_to_run(action))
                elif isinstance(action, int):
                    process.save_variables(action)
                else:
                    process.set(action)
            except StudentProcessError as failure:
                return index, failure
        return None

    def _start(self) -> StudentProcess:
        process = self._launcher.start(self._folder)
        process.deadline = self._deadline
        return process

    def _truncated(self, reply: Reply) -> Reply:
        remaining = max(self._launcher.limits.output_characters - self._printed, 0)
        self._printed += len(reply.stdout)
        return Reply(reply.ok, reply.value, reply.error, reply.stdout[:remaining])
