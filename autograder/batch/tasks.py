"""One submission to grade, as plain data, and the interface of what grades it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from autograder.intake.submission import Submission
from autograder.judge.judging import Assets, judge_submission
from autograder.judge.outcome import SubmissionResult
from autograder.sandbox.isolation import ProcessLauncher, temporary_workdir


@dataclass(frozen=True, slots=True)
class Task:
    """One submission to execute and judge; it holds no path, so another machine can run it.

    Attributes
    ----------
    submission : Submission
        Ready to be judged.
    assets : Assets
        What the judge needs.
    files : mapping
        Files of the student's work folder: content by file name.
    """

    submission: Submission
    assets: Assets
    files: Mapping[str, bytes]


class Executor(Protocol):
    """Executes and judges submissions, on this machine or on others."""

    @property
    def level(self) -> str:
        """The weakest isolation level of its results."""

    @property
    def max_pending(self) -> int:
        """How many tasks to submit at a time."""

    def run(self, task: Task) -> SubmissionResult:
        """Execute and judge a submission; thread-safe."""

    def close(self) -> None:
        """Abort running tasks."""


def run_task(task: Task, launcher: ProcessLauncher) -> SubmissionResult:
    """Execute and judge a submission on this machine."""
    with temporary_workdir() as workdir:
        for name, content in task.files.items():
            (workdir / name).write_bytes(content)
        return judge_submission(task.submission, task.assets, launcher, workdir)
