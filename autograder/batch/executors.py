"""Who executes and judges submissions: this machine, or a cluster. The office that hands them out knows no difference.

A task is all that judging a submission takes, as plain data: no path of the machine that hands it out.
"""

import contextlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Protocol

from autograder.intake.submission import Submission
from autograder.judge.judging import Assets, judge_submission
from autograder.judge.outcome import SubmissionResult
from autograder.sandbox.isolation import ProcessLauncher, open_launcher, temporary_workdir


@dataclass(frozen=True, slots=True)
class Task:
    """One submission to execute and judge.

    Attributes
    ----------
    submission : Submission
        Ready to be judged, as the intake made it.
    assets : Assets
        What the judge holds.
    files : mapping
        What lies in the student's work folder: content of each file, by its name there.
    """

    submission: Submission
    assets: Assets
    files: Mapping[str, bytes]


class Executor(Protocol):
    """Those who execute and judge."""

    @property
    def level(self) -> str:
        """The least isolation that its results come with."""

    @property
    def at_once(self) -> int:
        """How many tasks to hand out before the first one is back."""

    def judge(self, task: Task) -> SubmissionResult:
        """Execute and judge; called from several threads at a time."""

    def close(self) -> None:
        """Let go of everything that is under way."""


@dataclass(frozen=True, slots=True)
class LocalExecutor:
    """Executes in a launcher on this machine.

    Attributes
    ----------
    launcher : ProcessLauncher
        Starts students' processes.
    at_once : int
        Submissions at a time.
    """

    launcher: ProcessLauncher
    at_once: int = 1

    @property
    def level(self) -> str:
        """The level of the launcher."""
        return self.launcher.level

    def judge(self, task: Task) -> SubmissionResult:
        """Execute and judge."""
        return carry_out(task, self.launcher)

    def close(self) -> None:
        """End every process of the launcher."""
        self.launcher.close()


@contextlib.contextmanager
def open_executor(isolation: str, jobs: int, scheduler: str | None, tell: Callable[[str], None]) -> Iterator[Executor]:
    """Find those who judge: on this machine, or on a scheduler's workers.

    Parameters
    ----------
    isolation : str
        As `open_launcher` takes it.
    jobs : int
        Submissions at a time, on this machine.
    scheduler : str or None
        Address of a Dask scheduler.
    tell : callable
        Takes a line for the instructor.

    Raises
    ------
    ValueError
        If the demanded isolation, or the scheduler, cannot be had.
    """
    if scheduler is None:
        with open_launcher(isolation) as launcher:
            yield LocalExecutor(launcher, jobs)
    else:
        from autograder.batch.cluster import open_cluster

        with open_cluster(scheduler, isolation, tell) as cluster:
            yield cluster


def carry_out(task: Task, launcher: ProcessLauncher) -> SubmissionResult:
    """Execute and judge a submission in a launcher of the machine that this runs on."""
    with temporary_workdir() as bench:
        for name, content in task.files.items():
            (bench / name).write_bytes(content)
        return judge_submission(task.submission, task.assets, launcher, bench)
