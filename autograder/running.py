"""A student's notebook while it runs: within its limits, and brought back to where it was when its process dies."""

import contextlib
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from autograder.intake import Step
from autograder.isolation import Reply, Student, StudentDied, Workshop
from labsid.checks.values import Value


@dataclass(frozen=True, slots=True)
class Ran:
    """A cell that was gone through: what came back, or how the process died of it."""

    step: Step
    reply: Reply
    death: StudentDied | None = None


class Running:
    """One submission's process, or the one that took its place."""

    def __init__(self, workshop: Workshop, folder: Path) -> None:
        self._workshop = workshop
        self._folder = folder
        self._done: list[Step | Mapping[str, Value] | int] = []
        self._cells = 0
        self._printed = 0
        self._until = time.monotonic() + workshop.limits.submission_seconds
        self.student = self._start()

    def run(self, step: Step) -> Ran:
        """Run a cell; one that kills its process is left out of what the next process is brought back to."""
        most = self._workshop.limits.cells
        self._cells += 1
        if self._cells > most:
            return Ran(step, Reply(False), StudentDied("limit", f"the notebook has more than {most} cells"))
        try:
            reply = self.student.run(step.source)
        except StudentDied as death:
            self.revive()
            return Ran(step, Reply(False), death)
        self._done.append(step)
        return Ran(step, self._cut(reply))

    def set(self, values: Mapping[str, Value]) -> None:
        """Put values in the place of the student's own, now and in every process to come."""
        self._done.append(values)
        try:
            self.student.set(values)
        except StudentDied:
            self.revive()

    def pin(self, key: int) -> None:
        """Keep the variables as they are now under a key, in this process and in every process to come."""
        self._done.append(key)
        try:
            self.student.pin(key)
        except StudentDied:
            self.revive()

    def revive(self) -> None:
        """Start another process and bring it to where the last one was, without what killed it."""
        while True:
            self.student.close()
            if time.monotonic() > self._until:
                return
            try:
                self.student = self._start()
            except StudentDied:  # its folder was made unusable: what is asked of it now fails, and is tried again
                return
            failed = self._replay(self.student, len(self._done))
            if failed is None:
                return
            del self._done[failed]  # this cell does not survive being run again: go without it

    def replayed(self, key: int) -> Student | None:
        """A new process, brought to where the first one was when it kept its variables under that key."""
        try:
            student = self._start()
        except StudentDied:
            return None
        if self._replay(student, self._done.index(key)) is None:
            return student
        student.close()
        return None

    def more_time(self, seconds: float) -> None:
        """See to it that there are so many seconds left."""
        self._until = self.student.until = max(self._until, time.monotonic() + seconds)

    def close(self) -> None:
        """End it."""
        self.student.close()

    def _replay(self, student: Student, count: int) -> int | None:
        """Do again what was done; the place of what the process did not survive."""
        for index, done in enumerate(self._done[:count]):
            try:
                if isinstance(done, Step):
                    student.run(done.source)
                elif isinstance(done, int):
                    student.pin(done)
                else:
                    student.set(done)
            except StudentDied:
                return index
        return None

    def _start(self) -> Student:
        with contextlib.suppress(OSError):
            self._folder.mkdir(0o700, exist_ok=True)  # student code may have taken it away
        student = self._workshop.start(self._folder)
        student.until = self._until
        return student

    def _cut(self, reply: Reply) -> Reply:
        left = max(self._workshop.limits.output_characters - self._printed, 0)
        self._printed += len(reply.stdout)
        return Reply(reply.ok, reply.value, reply.error, reply.stdout[:left])
