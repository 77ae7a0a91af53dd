"""Isolation of student code: one process for each submission, at the strongest level that works on this machine.

There are three levels. At "namespaces", every submission has its own bubblewrap sandbox: no network, no other
processes, no files but the interpreter's, and one small writable folder. At "landlock", the kernel confines a plain
process to the same files. At "none", it is a plain process with limits. Each level adds a filter of system calls if the
system supports one. `open_launcher` probes a level before using it.
"""

import contextlib
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from autograder.sandbox.bubblewrap import SandboxError
from autograder.sandbox.confine import hide_memory
from autograder.sandbox.limits import Limits
from autograder.sandbox.process_launchers import ForkingLauncher, IsolationSetup, ProcessLauncher, SpawningLauncher
from autograder.sandbox.student_process import MachineError, Reply, StudentProcess, StudentProcessError
from autograder.sandbox.workdirs import remove_stale_workdirs, temporary_workdir

__all__ = [
    "LEVELS",
    "IsolationError",
    "Limits",
    "MachineError",
    "ProcessLauncher",
    "Reply",
    "StudentProcess",
    "StudentProcessError",
    "is_weaker",
    "launchers_by_level",
    "open_launcher",
    "probe_levels",
    "temporary_workdir",
]  # fmt: skip

LEVELS = ("namespaces", "landlock", "none")
"""Isolation levels, strongest first."""

_PROBE_CODE = """
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


_UNSUPPORTED = "this system does not support it"


class IsolationError(ValueError):
    """The requested isolation is unavailable on this machine."""


@dataclass(frozen=True, slots=True)
class IsolationLevel:
    """An isolation level, and whether this machine supports it.

    Attributes
    ----------
    name : str
        One of `LEVELS`.
    problem : str
        Why it is unavailable; empty if it is available.
    """

    name: str
    problem: str


@contextlib.contextmanager
def open_launcher(isolation: str = "best", limits: Limits | None = None) -> Iterator[ProcessLauncher]:
    """Open a launcher at the strongest permitted isolation level.

    Parameters
    ----------
    isolation : {"strict", "best", "none"} or a level
        ``strict`` requires kernel namespaces; ``best`` uses the strongest level that passes its probe; the name of a
        level requires that one.
    limits : Limits, optional
        Limits of one submission.

    Raises
    ------
    IsolationError
        If the requested isolation is unavailable.
    """
    remove_stale_workdirs()
    hide_memory()
    permitted = {"strict": LEVELS[:1], "best": LEVELS}.get(isolation, (isolation,))
    if not set(permitted) <= set(LEVELS):
        raise ValueError(f"isolation: got {isolation!r}, expected strict, best or one of {', '.join(LEVELS)}")
    launcher, unavailable = _open_strongest(permitted, limits or Limits())
    if launcher is None:
        problems = {level.problem.rstrip(".") for level in unavailable}
        named = (f"{level.name}: {level.problem.rstrip('.')}" for level in unavailable)
        reasons = "; ".join(problems if len(problems) == 1 < len(unavailable) else named)
        raise IsolationError(
            f"isolation {isolation!r} is unavailable: {reasons}. 'labsid course doctor' tests this machine."
        )
    try:
        yield launcher
    finally:
        launcher.close()


def is_weaker(level: str, other: str) -> bool:
    """Whether a level isolates less than another; False if either is unknown."""
    return level in LEVELS and other in LEVELS and LEVELS.index(level) > LEVELS.index(other)


def launchers_by_level(limits: Limits | None = None) -> Iterator[tuple[IsolationLevel, ProcessLauncher | None]]:
    """Every isolation level, strongest first, with a launcher if this machine supports it.

    The launcher has this level until the next one is asked for.
    """
    limits = limits or Limits()
    remove_stale_workdirs()
    hide_memory()
    if not hasattr(os, "fork"):
        for name in LEVELS:
            known = name == "none"
            yield IsolationLevel(name, "" if known else _UNSUPPORTED), SpawningLauncher(limits) if known else None
        return
    try:
        launcher = ForkingLauncher(limits)
    except MachineError as error:
        yield from ((IsolationLevel(name, str(error)), None) for name in LEVELS)
        return
    try:
        for name in LEVELS:
            problem = _probe_level(launcher, name)
            yield IsolationLevel(name, problem), None if problem else launcher
    finally:
        launcher.close()


def probe_levels(limits: Limits | None = None) -> list[IsolationLevel]:
    """Probe every isolation level on this machine."""
    return [level for level, _ in launchers_by_level(limits)]


def _open_strongest(permitted: tuple[str, ...], limits: Limits) -> tuple[ProcessLauncher | None, list[IsolationLevel]]:
    """Open a launcher at the first permitted level that passes its probe; also returns the levels that failed."""
    if not hasattr(os, "fork"):
        failed = [IsolationLevel(name, _UNSUPPORTED) for name in permitted if name != "none"]
        return (SpawningLauncher(limits) if "none" in permitted else None), failed
    try:
        launcher = ForkingLauncher(limits)
    except MachineError as error:
        return None, [IsolationLevel(name, str(error)) for name in permitted]
    failed = []
    try:
        for name in permitted:
            problem = _probe_level(launcher, name)
            if not problem:
                return launcher, failed
            failed.append(IsolationLevel(name, problem))
    except BaseException:
        launcher.close()
        raise
    launcher.close()
    return None, failed


def _probe_level(launcher: ForkingLauncher, name: str) -> str:
    """Configure the launcher with the first setup of a level that passes its probe; the problem if none does."""
    problem = _UNSUPPORTED
    for setup in _setups(name):
        problem = _probe(launcher, setup)
        if not problem:
            break
    return problem


def _setups(name: str) -> list[IsolationSetup]:
    """The setups of a level on this machine, best first."""
    root = os.name == "posix" and os.geteuid() == 0
    if name != "none" and sys.platform != "linux":
        return []
    if name == "namespaces":
        unprivileged = IsolationSetup(name, own_user_namespace=True)
        return [IsolationSetup(name, own_user=True), unprivileged] if root else [unprivileged]
    plain = IsolationSetup(name)
    return [IsolationSetup(name, own_user=True), plain] if root and sys.platform == "linux" else [plain]


def _probe(launcher: ForkingLauncher, setup: IsolationSetup) -> str:
    """Run code in a process of this setup that checks its isolation; returns the problem, or an empty string."""
    with temporary_workdir() as folder, temporary_workdir() as outside:
        canary = outside / "canary"
        canary.write_text("not for students", encoding="utf-8")
        try:
            launcher.configure(setup)
            student = launcher.start(folder)
        except (MachineError, SandboxError) as error:
            return str(error)
        try:
            ran = student.run(_PROBE_CODE.format(canary=str(canary)))
            seen, broken = student.value("seen").value, student.value("broken").value
        except StudentProcessError as error:
            return str(error)
        finally:
            student.close()
    if not ran.ok or broken:
        return f"the probe failed ({broken or ran.error})"
    return "the files of this machine stay visible" if seen is not False and setup.level != "none" else ""
