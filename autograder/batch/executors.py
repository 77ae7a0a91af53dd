"""The choice between grading on this machine and on a cluster."""

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from autograder.batch.cluster import open_cluster
from autograder.batch.judge_process import JudgeProcess
from autograder.batch.tasks import Executor, Task, run_task
from autograder.judge.outcome import SubmissionResult
from autograder.sandbox.isolation import ProcessLauncher, open_launcher


@dataclass(frozen=True, slots=True)
class LocalExecutor:
    """Executes and judges on this machine.

    Attributes
    ----------
    launcher : ProcessLauncher
        Starts students' processes.
    max_pending : int
        Submissions at a time.
    """

    launcher: ProcessLauncher
    max_pending: int = 1

    @property
    def level(self) -> str:
        """The launcher's isolation level."""
        return self.launcher.level

    def run(self, task: Task, judge: JudgeProcess) -> SubmissionResult:
        """Execute and judge a submission."""
        return judge.call(run_task, task, launcher=self.launcher)

    def close(self) -> None:
        """End every student process."""
        self.launcher.close()


@contextlib.contextmanager
def open_executor(
    isolation: str, jobs: int, scheduler: str | None, notify: Callable[[str], None]
) -> Iterator[Executor]:
    """Open an executor on this machine, or on the workers of a scheduler.

    Parameters
    ----------
    isolation : str
        As `open_launcher` takes it.
    jobs : int
        Submissions at a time on this machine.
    scheduler : str or None
        Address of a Dask scheduler.
    notify : callable
        Takes a line for the instructor.

    Raises
    ------
    ValueError
        If the requested isolation or the scheduler is unavailable.
    """
    if scheduler is None:
        with open_launcher(isolation) as launcher:
            yield LocalExecutor(launcher, jobs)
    else:
        with open_cluster(scheduler, isolation, notify) as cluster:
            yield cluster
