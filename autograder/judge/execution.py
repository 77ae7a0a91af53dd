"""Execution of a student's notebook: within its limits, with the state restored when its process ends."""

import errno
import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from autograder.course.definitions import definitions_in
from autograder.intake.submission import NotebookCell
from autograder.judge.served_functions import RightFunctions
from autograder.sandbox.isolation import MachineError, ProcessLauncher, Reply, StudentProcess, StudentProcessError
from autograder.sandbox.replacing import Replacement
from autograder.sandbox.workdirs import disk_is_full


@dataclass(frozen=True, slots=True)
class RunCell:
    """A cell to run, statement by statement if wrong values are replaced in it."""

    cell: NotebookCell
    replacements: tuple[Replacement, ...] = ()


@dataclass(frozen=True, slots=True)
class ReadVariables:
    """Variables to read: a student's object may answer differently each time."""

    names: tuple[str, ...]


Action = RunCell | Replacement | ReadVariables | int
"""A step of a run: a cell, what replaces a wrong answer, variables to read, or the key to save the variables under."""


def with_replacements(action: Action, new: Mapping[int, Replacement]) -> Action:
    """An action with other replacements, by the identity of those that they take the place of."""
    if isinstance(action, RunCell):
        return replace(action, replacements=tuple(new.get(id(one), one) for one in action.replacements))
    return new.get(id(action), action) if isinstance(action, Replacement) else action


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
    functions : RightFunctions, optional
        The functions that may be served: in the second run, whose cells have all run within their time.

    Attributes
    ----------
    process : StudentProcess
        The current process.
    actions : list of Action
        What has been done, without the cells that ended their process.
    """

    def __init__(
        self,
        launcher: ProcessLauncher,
        folder: Path,
        deadline: float | None = None,
        functions: RightFunctions | None = None,
    ) -> None:
        self._launcher = launcher
        self._folder = folder
        self._functions = functions
        self._cells = 0
        self._printed = 0
        self._deadline = time.monotonic() + launcher.limits.submission_seconds if deadline is None else deadline
        self._replay_seconds = launcher.limits.submission_seconds
        self._served: set[str] = set()  # functions, in the current process
        self._left_out: list[tuple[Action, StudentProcessError]] = []
        self.actions: list[Action] = []
        self.process = self._start()

    def run(self, cell: NotebookCell) -> ExecutedCell:
        """Run a cell, if it is one to be run; one that ends its process is not replayed in the next process."""
        if not source_to_run(cell):
            return ExecutedCell(cell, Reply(True))
        max_cells = self._launcher.limits.cells
        self._cells += cell.kind in ("answer", "extra")
        if self._cells > max_cells:
            failure = StudentProcessError("limit", f"the notebook has more than {max_cells} cells of your own code")
            return ExecutedCell(cell, Reply(False), failure)
        action = RunCell(cell, self._replacing() if cell.kind in ("answer", "extra") else ())
        try:
            reply = self.process.run(source_to_run(cell), action.replacements, again=self._functions is not None)
        except StudentProcessError as failure:
            self.restart()
            return ExecutedCell(cell, Reply(False), failure)
        if _NO_SPACE in str((reply.error or {}).get("text")) and disk_is_full():
            raise MachineError(_NO_SPACE)
        self.actions.append(action)
        return ExecutedCell(cell, self._truncated(reply))

    def replace(self, replacement: Replacement) -> None:
        """Set right values, and functions that are served, in this process and in every later one."""
        self._do(replacement)

    def replace_where_made(self, replacement: Replacement) -> None:
        """Run all cells again in another process; wrong values are replaced where students' statements make them."""
        actions = (
            replace(action, replacements=(*action.replacements, replacement))
            if isinstance(action, RunCell) and action.cell.kind in ("answer", "extra")
            else action
            for action in self.actions
        )
        self.do_again([*actions, replacement])

    def do_again(self, actions: Sequence[Action]) -> None:
        """Do these actions in another process."""
        self.actions = list(actions)
        self.restart()

    def read_variables(self, *names: str) -> None:
        """Read variables in every later process, as they have been read in this one."""
        self.actions.append(ReadVariables(names))

    def save_variables(self, key: int) -> None:
        """Save the current variables under a key, in this process and in every later one."""
        self._do(key)

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
            failed = self._replay(self.process, self.actions)
            if failed is None:
                return
            self._left_out.append((self.actions.pop(failed[0]), failed[1]))

    def restore_variables(self, key: int) -> bool:
        """Restore the variables saved under a key; returns whether any of them was modified in place.

        Raises
        ------
        StudentProcessError
            With the reason, if they could not be saved or restored.
        """
        for action, failure in self._left_out:
            if isinstance(action, int) and action == key:
                raise StudentProcessError(failure.status, f"its variables could not be saved: {failure}")
        return self.process.restore_variables(key)

    def said_of_left_out(self) -> str:
        """What to say of an answer that is judged in a process without some cell; empty if there is none."""
        failures = [failure for action, failure in self._left_out if isinstance(action, RunCell)]
        if not failures:
            return ""
        return f"When the notebook was run a second time, a cell did not finish ({failures[0]}); judged without it:"

    def replayed(self, key: int) -> StudentProcess:
        """Start a process and replay the actions up to the point where the variables were saved under `key`.

        Raises
        ------
        StudentProcessError
            If the process ends during the replay.
        """
        process = self._start()
        try:
            self._timed_replay(process, self.actions[: self.actions.index(key)])
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

    def _timed_replay(self, process: StudentProcess, actions: Sequence[Action]) -> None:
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

    def _do(self, action: Action) -> None:
        self.actions.append(action)
        try:
            self._perform(self.process, action)
        except StudentProcessError:
            self.restart()

    def _replay(self, process: StudentProcess, actions: Sequence[Action]) -> tuple[int, StudentProcessError] | None:
        """Replay actions; returns the index and the error of the one that ended the process."""
        for index, action in enumerate(actions):
            try:
                self._perform(process, action)
            except StudentProcessError as failure:
                return index, failure
        return None

    def _perform(self, process: StudentProcess, action: Action) -> None:
        if isinstance(action, RunCell):
            if self._functions is not None:
                self._functions.start_question()
            self._serve(*action.replacements)
            process.run(source_to_run(action.cell), action.replacements, again=True)
        elif isinstance(action, Replacement):
            self._serve(action)
            process.replace(action)
        elif isinstance(action, ReadVariables):
            for name in action.names:
                process.value(name)
        else:
            process.save_variables(action)

    def _replacing(self) -> tuple[Replacement, ...]:
        """What has been replaced so far: a later cell may make the same wrong values once more."""
        return tuple(action for action in self.actions if isinstance(action, Replacement))

    def _serve(self, *replacements: Replacement) -> None:
        self._served.update(name for one in replacements for name in one.functions)

    def _start(self) -> StudentProcess:
        process = self._launcher.start(self._folder)
        process.deadline = self._deadline
        functions, self._served = self._functions, set()
        if functions is not None:
            process.server = partial(functions.reply, student=process, served=self._served)
        return process

    def _truncated(self, reply: Reply) -> Reply:
        remaining = max(self._launcher.limits.output_characters - self._printed, 0)
        self._printed += len(reply.stdout)
        return Reply(reply.ok, reply.value, reply.error, reply.stdout[:remaining])
