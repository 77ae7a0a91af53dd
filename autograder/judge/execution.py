"""A student's notebook while it runs: within its limits, and brought back to where it was when its process dies."""

import contextlib
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from autograder.intake.submission import NotebookCell
from autograder.sandbox.isolation import ProcessLauncher, Reply, StudentProcess, StudentProcessError
from labsid.checks.values import Value

_Action = NotebookCell | Mapping[str, Value] | int
"""What a process went through: a cell that it ran, values that it was given, the key of a pin."""

_SECOND_PROCESS_KEY = -1


@dataclass(frozen=True, slots=True)
class ExecutedCell:
    """A cell that was gone through: what came back, or how the process died of it."""

    step: NotebookCell
    reply: Reply
    death: StudentProcessError | None = None


class Execution:
    """One submission's process, or the one that took its place."""

    def __init__(self, launcher: ProcessLauncher, folder: Path) -> None:
        self._launcher = launcher
        self._folder = folder
        self._done: list[_Action] = []
        self._other: StudentProcess | None = None
        self._gone_through = 0  # by the other, of what was done
        self._cells = 0
        self._printed = 0
        self._until = time.monotonic() + launcher.limits.submission_seconds
        self._again = launcher.limits.submission_seconds
        self.student = self._start()

    def run(self, step: NotebookCell) -> ExecutedCell:
        """Run a cell; one that kills its process is left out of what the next process is brought back to."""
        most = self._launcher.limits.cells
        self._cells += 1
        if self._cells > most:
            return ExecutedCell(
                step, Reply(False), StudentProcessError("limit", f"the notebook has more than {most} cells")
            )
        try:
            reply = self.student.run(step.source)
        except StudentProcessError as death:
            self.revive()
            return ExecutedCell(step, Reply(False), death)
        self._done.append(step)
        return ExecutedCell(step, self._cut(reply))

    def set(self, values: Mapping[str, Value]) -> None:
        """Put values in the place of the student's own, now and in every process to come."""
        self._done.append(values)
        try:
            self.student.set(values)
        except StudentProcessError:
            self.revive()

    def pin(self, key: int) -> None:
        """Keep the variables as they are now under a key, in this process and in every process to come."""
        self._done.append(key)
        try:
            self.student.save_variables(key)
        except StudentProcessError:
            self.revive()

    def revive(self) -> None:
        """Start another process and bring it to where the last one was, without what killed it."""
        while True:
            self.student.close()
            if time.monotonic() > self._until:
                return
            try:
                self.student = self._start()
            except StudentProcessError:  # what is asked of it now fails, and is tried again
                return
            failed = self._replay(self.student, self._done)
            if failed is None:
                return
            self._part()
            del self._done[failed[0]]  # this cell does not survive being run again: go without it

    def replayed(self, key: int) -> StudentProcess:
        """A new process, brought to where the first one was when it kept its variables under `key`.

        Raises
        ------
        StudentProcessError
            If it does not survive that.
        """
        student = self._start()
        try:
            self._bring(student, self._done[: self._done.index(key)])
        except BaseException:
            student.close()
            raise
        return student

    @contextlib.contextmanager
    def apart(self) -> Iterator[StudentProcess]:
        """Another process at the same place, to call functions on hidden inputs while there are cells to come.

        It has neither memory nor a folder in common with the first, so what it is told stays with it. It is kept for
        the next time, and then goes on from where it was; not where its variables have changed since.

        Raises
        ------
        StudentProcessError
            If it does not survive to get there.
        """
        if self._other is None:
            self._other, self._gone_through = self._start(), 0
        other, behind = self._other, self._done[self._gone_through :]
        changed = True
        try:
            self._bring(other, behind)
            self._gone_through = len(self._done)
            other.save_variables(_SECOND_PROCESS_KEY)
            yield other
            with contextlib.suppress(StudentProcessError):
                changed = other.restore_variables(_SECOND_PROCESS_KEY)
        finally:
            if changed:
                self._part()

    def more_time(self, seconds: float) -> None:
        """See to it that there are so many seconds left."""
        self._until = self.student.deadline = max(self._until, time.monotonic() + seconds)

    def close(self) -> None:
        """End it."""
        self._part()
        self.student.close()

    def _part(self) -> None:
        if self._other is not None:
            self._other.close()
            self._other = None

    def _bring(self, student: StudentProcess, done: list[_Action]) -> None:
        """Replay at the judge's wish: the time is not the notebook's, and all of it may come to as much again."""
        began = time.monotonic()
        student.deadline = began + self._again
        failed = self._replay(student, done)
        gone = time.monotonic() - began
        self._again -= gone
        self._until += gone
        self.student.deadline = student.deadline = self._until
        if failed is not None:
            student.close()
            raise StudentProcessError(failed[1].status, f"run once more from the first cell on, {failed[1]}")

    def _replay(self, student: StudentProcess, done: list[_Action]) -> tuple[int, StudentProcessError] | None:
        """Do again what was done; the place of what the process did not survive, and how it died."""
        for index, one in enumerate(done):
            try:
                if isinstance(one, NotebookCell):
                    student.run(one.source)
                elif isinstance(one, int):
                    student.save_variables(one)
                else:
                    student.set(one)
            except StudentProcessError as death:
                return index, death
        return None

    def _start(self) -> StudentProcess:
        student = self._launcher.start(self._folder)
        student.deadline = self._until
        return student

    def _cut(self, reply: Reply) -> Reply:
        left = max(self._launcher.limits.output_characters - self._printed, 0)
        self._printed += len(reply.stdout)
        return Reply(reply.ok, reply.value, reply.error, reply.stdout[:left])
