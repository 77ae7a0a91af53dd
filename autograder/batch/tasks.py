"""One submission to grade, as plain data, and the interface of what grades it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol

from autograder.batch.judge_process import JudgeError, JudgeProcess
from autograder.intake.submission import Submission, quarantined_submission
from autograder.judge.judging import Assets, judge_submission
from autograder.judge.outcome import SubmissionResult, ungraded_result
from autograder.judge.redaction import numbers_in, redact_reason
from autograder.sandbox.isolation import MachineError, ProcessLauncher, temporary_workdir
from labsid.checks.cells import Template

_SEARCHED_CHARACTERS = 100_000  # of a cell
_NEAR = 10  # samples: mistakes with the ends of a record


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

    def run(self, task: Task, judge: JudgeProcess) -> SubmissionResult:
        """Execute and judge a submission; thread-safe.

        Parameters
        ----------
        task : Task
        judge : JudgeProcess
            For judging on this machine.

        Raises
        ------
        JudgeError
            If judging it exceeds the limits.
        MachineError
            If a machine could not start its processes.
        """

    def close(self) -> None:
        """Abort running tasks."""


def run_task(task: Task, launcher: ProcessLauncher) -> SubmissionResult:
    """Execute and judge a submission on this machine."""
    with temporary_workdir() as workdir:
        for name, content in task.files.items():
            (workdir / name).write_bytes(content)
        result = judge_submission(task.submission, task.assets, launcher, workdir)
    return redact_reasons(result, task)


def redact_reasons(result: SubmissionResult, task: Task) -> SubmissionResult:
    """The result with reasons of limited length, whose numbers are those of the notebook and of its record."""
    known = numbers_in(
        *(cell.source for cell in task.assets.template.cells),
        *(cell.source[:_SEARCHED_CHARACTERS] for cell in task.submission.cells),
        *(question.id for question in task.assets.assignment.questions),
    )
    size = 0 if task.assets.record is None else len(task.assets.record)
    known |= {str(part + n) for part in (size, size // 2, 2 * size) for n in range(-_NEAR, _NEAR + 1)}
    questions = tuple(replace(one, reason=redact_reason(one.reason, known)) for one in result.results)
    return replace(result, results=questions)


def refused_result(student: str, template: Template, level: str, error: JudgeError | MachineError) -> SubmissionResult:
    """The result of a submission that could not be judged: quarantined, with details for the instructor."""
    refused = quarantined_submission(student, template.assignment, f"it could not be judged: {error}")
    result = ungraded_result(refused, template, level)
    details = error.details if isinstance(error, JudgeError) else ""
    return replace(result, flags=(f"could not be judged: {error} {details}".rstrip(),))
