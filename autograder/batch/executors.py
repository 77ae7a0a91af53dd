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
from autograder.sandbox.isolation import Workshop, bench_folder, open_workshop


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


class Crew(Protocol):
    """Those who execute and judge."""

    @property
    def rung(self) -> str:
        """The least isolation that its results come with."""

    @property
    def at_once(self) -> int:
        """How many tasks to hand out before the first one is back."""

    def judge(self, task: Task) -> SubmissionResult:
        """Execute and judge; called from several threads at a time."""

    def close(self) -> None:
        """Let go of everything that is under way."""


@dataclass(frozen=True, slots=True)
class LocalCrew:
    """Executes in a workshop on this machine.

    Attributes
    ----------
    workshop : Workshop
        Starts students' processes.
    at_once : int
        Submissions at a time.
    """

    workshop: Workshop
    at_once: int = 1

    @property
    def rung(self) -> str:
        """The rung of the workshop."""
        return self.workshop.rung

    def judge(self, task: Task) -> SubmissionResult:
        """Execute and judge."""
        return carry_out(task, self.workshop)

    def close(self) -> None:
        """End every process of the workshop."""
        self.workshop.close()


@contextlib.contextmanager
def open_crew(isolation: str, jobs: int, scheduler: str | None, tell: Callable[[str], None]) -> Iterator[Crew]:
    """Find those who judge: on this machine, or on a scheduler's workers.

    Parameters
    ----------
    isolation : str
        As `open_workshop` takes it.
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
        with open_workshop(isolation) as workshop:
            yield LocalCrew(workshop, jobs)
    else:
        from autograder.batch.cluster import open_cluster

        with open_cluster(scheduler, isolation, tell) as cluster:
            yield cluster


def carry_out(task: Task, workshop: Workshop) -> SubmissionResult:
    """Execute and judge a submission in a workshop of the machine that this runs on."""
    with bench_folder() as bench:
        for name, content in task.files.items():
            (bench / name).write_bytes(content)
        return judge_submission(task.submission, task.assets, workshop, bench)
