"""Where student code runs: one process a submission, apart from the judge, and how far it is held in.

The ladder has three levels. On "namespaces", every submission has a bubblewrap sandbox of its own: no network, no other
processes, of the files the interpreter alone, one small place to write. On "landlock", the kernel confines a plain
process to the same files. On "none", it is a plain process with limits. A filter of system calls comes on top of each
where the system has one. `open_launcher` tries a level before it stands on it.
"""

import contextlib
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from autograder.sandbox.bubblewrap import SandboxError
from autograder.sandbox.limits import Limits
from autograder.sandbox.process_launchers import ForkingLauncher, ProcessLauncher, SpawningLauncher, Way
from autograder.sandbox.student_process import Reply, StudentProcess, StudentProcessError
from autograder.sandbox.workdirs import remove_stale_workdirs, temporary_workdir

__all__ = [
    "LEVELS",
    "IsolationError",
    "Limits",
    "ProcessLauncher",
    "Reply",
    "StudentProcess",
    "StudentProcessError",
    "is_weaker",
    "open_launcher",
    "probe_levels",
    "temporary_workdir",
]  # fmt: skip

LEVELS = ("namespaces", "landlock", "none")
"""Rungs of the ladder, strongest first; "none" is a plain process with limits."""

_PROBE = """
import os, numpy
seen = True
try:
    open({canary!r}).close()
except OSError:
    seen = False
broken = ""
for path, mode in ((os.__file__, "r"), (numpy.__file__, "r"), ("probe", "w")):
    try:
        open(path, mode).close()
    except OSError as error:
        broken = f"{{path}}: {{error.strerror}}"
"""


class IsolationError(ValueError):
    """The demanded isolation cannot be had on this machine."""


@dataclass(frozen=True, slots=True)
class IsolationLevel:
    """A level as it stands on this machine.

    Attributes
    ----------
    name : str
        One of `LEVELS`.
    why_not : str
        Why it cannot be had; empty where it can.
    """

    name: str
    why_not: str


@contextlib.contextmanager
def open_launcher(isolation: str = "best", limits: Limits | None = None) -> Iterator[ProcessLauncher]:
    """Open the best launcher that this machine has.

    Parameters
    ----------
    isolation : {"strict", "best", "none"} or a level
        ``strict`` demands kernel namespaces; ``best`` takes the strongest level that holds when it is tried here;
        the name of a level demands that one.
    limits : Limits, optional
        What one submission may use.

    Raises
    ------
    IsolationError
        If what is demanded cannot be had.
    """
    remove_stale_workdirs()
    wanted = {"strict": LEVELS[:1], "best": LEVELS}.get(isolation, (isolation,))
    if not set(wanted) <= set(LEVELS):
        raise ValueError(f"isolation: got {isolation!r}, expected strict, best or one of {', '.join(LEVELS)}")
    launcher, tried = _climb(wanted, limits or Limits())
    if launcher is None:
        reasons = "; ".join(f"{level.name}: {level.why_not.rstrip('.')}" for level in tried)
        raise IsolationError(
            f"isolation {isolation!r} cannot be had: {reasons}. 'labsid course doctor' says what this machine holds."
        )
    try:
        yield launcher
    finally:
        launcher.close()


def is_weaker(level: str, wanted: str) -> bool:
    """Whether one level isolates less than another; one that is not known does not."""
    return level in LEVELS and wanted in LEVELS and LEVELS.index(level) > LEVELS.index(wanted)


def probe_levels(limits: Limits | None = None) -> list[IsolationLevel]:
    """Try every level of the ladder on this machine."""
    found = []
    for name in LEVELS:
        launcher, tried = _climb((name,), limits or Limits())
        if launcher is not None:
            launcher.close()
        found.append(IsolationLevel(name, "" if launcher is not None else tried[0].why_not))
    return found


def _climb(wanted: tuple[str, ...], limits: Limits) -> tuple[ProcessLauncher | None, list[IsolationLevel]]:
    """The first of the wanted levels that holds when it is tried, and those that did not."""
    if not hasattr(os, "fork"):
        tried = [IsolationLevel(name, "this system has no such isolation") for name in wanted if name != "none"]
        return (SpawningLauncher(limits) if "none" in wanted else None), tried
    try:
        launcher = ForkingLauncher(limits)
    except StudentProcessError as died:
        return None, [IsolationLevel(name, str(died)) for name in wanted]
    tried = []
    try:
        for name in wanted:
            why_not = "this system has no such isolation"
            for way in _ways(name):
                why_not = _try(launcher, way)
                if not why_not:
                    return launcher, tried
            tried.append(IsolationLevel(name, why_not))
    except BaseException:
        launcher.close()
        raise
    launcher.close()
    return None, tried


def _ways(name: str) -> list[Way]:
    """How a level can be built here, best first."""
    root = os.name == "posix" and os.geteuid() == 0
    if name != "none" and sys.platform != "linux":
        return []
    if name == "namespaces":
        shared = Way(name, own_user_namespace=True)
        return [Way(name, own_user=True), shared] if root else [shared]
    return [Way(name, own_user=True), Way(name)] if root and sys.platform == "linux" else [Way(name)]


def _try(launcher: ForkingLauncher, way: Way) -> str:
    """Stand on a level and run code there that looks around; why it does not hold, or nothing."""
    with temporary_workdir() as folder, temporary_workdir() as outside:
        canary = outside / "canary"
        canary.write_text("not for students", encoding="utf-8")
        try:
            launcher.stand_on(way)
            student = launcher.start(folder)
        except (StudentProcessError, SandboxError) as error:
            return str(error)
        try:
            ran = student.run(_PROBE.format(canary=str(canary)))
            seen, broken = student.value("seen").value, student.value("broken").value
        except StudentProcessError as error:
            return str(error)
        finally:
            student.close()
    if not ran.ok or broken:
        return f"a trial failed ({broken or ran.error})"
    return "the files of this machine stay in sight" if seen is not False and way.level != "none" else ""
