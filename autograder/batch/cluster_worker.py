"""What a worker of a cluster does: it says how it isolates, and carries tasks out in a launcher of its own.

A worker's process is trusted, as the grader's is elsewhere: it holds checks and right values. Students' processes are
forked from the launcher's parent, a program of its own that inherits none of the worker's connections.
"""

import atexit
import contextlib
from dataclasses import dataclass
from threading import Lock

from autograder.batch.executors import Task, carry_out
from autograder.batch.fingerprint import JUDGING, checks_module, environment
from autograder.course.sources import sources_hash
from autograder.judge.outcome import SubmissionResult
from autograder.sandbox.doctor import TCP, holds
from autograder.sandbox.isolation import Limits, ProcessLauncher, open_launcher
from labsid.checks.notebook import assignment_names, load_assignment


@dataclass(frozen=True, slots=True)
class Demand:
    """What a worker must fulfil to take tasks.

    Attributes
    ----------
    sources : str
        Fingerprint of all the code that judges.
    environment : tuple of str
        Versions of Python and of the packages that results depend on.
    isolation : str
        As `open_launcher` takes it.
    limits : Limits
        What one submission may use.
    """

    sources: str
    environment: tuple[str, ...]
    isolation: str
    limits: Limits


def demand(isolation: str, limits: Limits) -> Demand:
    """What this machine demands of others: that they judge as it would itself."""
    checks = [checks_module(name) for name in assignment_names()]
    return Demand(sources_hash(__name__, *JUDGING, *checks), environment(), isolation, limits)


@dataclass(frozen=True, slots=True)
class Failed:
    """What a worker answers where it does not do what it was asked; raised, it might not survive the way back.

    Attributes
    ----------
    why : str
    """

    why: str


def greet(demanded: Demand) -> str | Failed:
    """The level on which this worker executes."""
    try:
        return _launcher(demanded).level
    except ValueError as error:
        return Failed(str(error))


def work(demanded: Demand, task: Task) -> SubmissionResult | Failed:
    """Execute and judge a submission."""
    try:
        return carry_out(task, _launcher(demanded))
    except Exception as error:
        return Failed(f"{type(error).__name__}: {error}")


_OPEN: dict[Demand, ProcessLauncher] = {}
_OPENING = Lock()
_TO_CLOSE = contextlib.ExitStack()
atexit.register(_TO_CLOSE.close)


def _launcher(demanded: Demand) -> ProcessLauncher:
    """This process's launcher, opened when it is first asked for."""
    with _OPENING:
        if demanded not in _OPEN:
            _OPEN[demanded] = _open(demanded)
        return _OPEN[demanded]


def _open(demanded: Demand) -> ProcessLauncher:
    for name in assignment_names():
        load_assignment(name)  # what is in memory must be what the fingerprint is of
    here = demand(demanded.isolation, demanded.limits)
    if here.sources != demanded.sources:
        raise ValueError("its labsid has other sources than this machine's: install the same version, and restart it")
    pairs = zip(here.environment, demanded.environment, strict=True)
    if differing := [f"{mine} instead of {wanted}" for mine, wanted in pairs if mine != wanted]:
        raise ValueError(f"it has {', '.join(differing)}: install what this machine has, and restart it")
    with contextlib.ExitStack() as stack:
        launcher = stack.enter_context(open_launcher(demanded.isolation, demanded.limits))
        if demanded.isolation != "none" and not holds(launcher, TCP):
            raise ValueError(
                "student code on it could connect to the scheduler; --isolation none takes such a worker all the same"
            )
        _TO_CLOSE.push(stack.pop_all())
    return launcher
