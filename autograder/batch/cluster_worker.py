"""The functions that run on a cluster's workers: a check of the worker, and the grading of a task.

A worker's process is trusted: it holds checks and right values. It starts student processes through a fork server, a
separate program that inherits none of the worker's connections.
"""

import atexit
import contextlib
from dataclasses import dataclass
from threading import Lock

from autograder.batch.fingerprint import JUDGING, checks_module, environment
from autograder.batch.judge_process import JudgeError, JudgePool
from autograder.batch.tasks import Task, refused_result, run_task
from autograder.course.sources import sources_hash
from autograder.judge.outcome import SubmissionResult
from autograder.sandbox.doctor import is_blocked
from autograder.sandbox.escapes import TCP
from autograder.sandbox.isolation import Limits, ProcessLauncher, open_launcher
from labsid.checks.notebook import assignment_names, load_assignment


@dataclass(frozen=True, slots=True)
class WorkerRequirements:
    """What a worker must match to take tasks.

    Attributes
    ----------
    sources : str
        Fingerprint of all code that results depend on.
    environment : tuple of str
        Versions of Python and of the packages that results depend on.
    isolation : str
        As `open_launcher` takes it.
    limits : Limits
        Limits of one submission.
    """

    sources: str
    environment: tuple[str, ...]
    isolation: str
    limits: Limits


def worker_requirements(isolation: str, limits: Limits) -> WorkerRequirements:
    """The requirements that make a worker grade as this machine does."""
    checks = [checks_module(name) for name in assignment_names()]
    return WorkerRequirements(sources_hash(__name__, *JUDGING, *checks), environment(), isolation, limits)


@dataclass(frozen=True, slots=True)
class Failure:
    """Why a worker did not do what it was asked; returned, as not every exception can be pickled.

    Attributes
    ----------
    reason : str
    """

    reason: str


def check_worker(requirements: WorkerRequirements) -> str | Failure:
    """The isolation level of this worker, or why it does not meet the requirements."""
    try:
        return _launcher(requirements).level
    except ValueError as error:
        return Failure(str(error))


def run_on_worker(requirements: WorkerRequirements, task: Task) -> SubmissionResult | Failure:
    """Execute and judge a submission."""
    try:
        launcher = _launcher(requirements)
        with _JUDGES.borrow() as judge:
            return judge.call(run_task, task, launcher=launcher)
    except JudgeError as error:
        return refused_result(task.submission.student, task.assets.template, launcher.level, error)
    except Exception as error:
        return Failure(f"{type(error).__name__}: {error}")


_JUDGES = JudgePool()
_LAUNCHERS: dict[WorkerRequirements, ProcessLauncher] = {}
_OPENING = Lock()
_TO_CLOSE = contextlib.ExitStack()
atexit.register(_TO_CLOSE.close)
atexit.register(_JUDGES.close)


def _launcher(requirements: WorkerRequirements) -> ProcessLauncher:
    """This process's launcher, opened on first use."""
    with _OPENING:
        if requirements not in _LAUNCHERS:
            _LAUNCHERS[requirements] = _open(requirements)
        return _LAUNCHERS[requirements]


def _open(requirements: WorkerRequirements) -> ProcessLauncher:
    for name in assignment_names():
        load_assignment(name)  # the fingerprint is of the files, so the code in memory must be theirs
    own = worker_requirements(requirements.isolation, requirements.limits)
    if own.sources != requirements.sources:
        raise ValueError("its labsid has other sources than this machine's: install the same version, and restart it")
    pairs = zip(own.environment, requirements.environment, strict=True)
    if differing := [f"{mine} instead of {required}" for mine, required in pairs if mine != required]:
        raise ValueError(f"it has {', '.join(differing)}: install this machine's versions, and restart it")
    with contextlib.ExitStack() as stack:
        launcher = stack.enter_context(open_launcher(requirements.isolation, requirements.limits))
        if requirements.isolation != "none" and not is_blocked(launcher, TCP):
            raise ValueError(
                "student code on it could connect to the scheduler; --isolation none accepts such a worker"
            )
        _TO_CLOSE.push(stack.pop_all())
    return launcher
