"""Where student code runs: one process a submission, apart from the judge, and how far it is held in.

The ladder has three rungs. On "namespaces", every submission has a bubblewrap sandbox of its own: no network, no other
processes, of the files the interpreter alone, one small place to write. On "landlock", the kernel confines a plain
process to the same files. On "none", it is a plain process with limits. A filter of system calls comes on top of each
where the system has one. `open_workshop` tries a rung before it stands on it.
"""

import contextlib
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from autograder.sandbox.bubblewrap import SandboxError
from autograder.sandbox.limits import Limits
from autograder.sandbox.process_launchers import ForkingWorkshop, SpawningWorkshop, Way, Workshop
from autograder.sandbox.student_process import Reply, Student, StudentDied
from autograder.sandbox.workdirs import bench_folder, clear_benches

__all__ = [
    "RUNGS", "IsolationError", "Limits", "Reply", "Student", "StudentDied", "Workshop", "bench_folder", "is_weaker",
    "open_workshop", "rungs_here",
]  # fmt: skip

RUNGS = ("namespaces", "landlock", "none")
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
class Rung:
    """A rung as it stands on this machine.

    Attributes
    ----------
    name : str
        One of `RUNGS`.
    why_not : str
        Why it cannot be had; empty where it can.
    """

    name: str
    why_not: str


@contextlib.contextmanager
def open_workshop(isolation: str = "best", limits: Limits | None = None) -> Iterator[Workshop]:
    """Open the best workshop that this machine has.

    Parameters
    ----------
    isolation : {"strict", "best", "none"} or a rung
        ``strict`` demands kernel namespaces; ``best`` takes the strongest rung that holds when it is tried here;
        the name of a rung demands that one.
    limits : Limits, optional
        What one submission may use.

    Raises
    ------
    IsolationError
        If what is demanded cannot be had.
    """
    clear_benches()
    wanted = {"strict": RUNGS[:1], "best": RUNGS}.get(isolation, (isolation,))
    if not set(wanted) <= set(RUNGS):
        raise ValueError(f"isolation: got {isolation!r}, expected strict, best or one of {', '.join(RUNGS)}")
    workshop, tried = _climb(wanted, limits or Limits())
    if workshop is None:
        reasons = "; ".join(f"{rung.name}: {rung.why_not.rstrip('.')}" for rung in tried)
        raise IsolationError(
            f"isolation {isolation!r} cannot be had: {reasons}. 'labsid course doctor' says what this machine holds."
        )
    try:
        yield workshop
    finally:
        workshop.close()


def is_weaker(rung: str, wanted: str) -> bool:
    """Whether one rung isolates less than another; one that is not known does not."""
    return rung in RUNGS and wanted in RUNGS and RUNGS.index(rung) > RUNGS.index(wanted)


def rungs_here(limits: Limits | None = None) -> list[Rung]:
    """Try every rung of the ladder on this machine."""
    found = []
    for name in RUNGS:
        workshop, tried = _climb((name,), limits or Limits())
        if workshop is not None:
            workshop.close()
        found.append(Rung(name, "" if workshop is not None else tried[0].why_not))
    return found


def _climb(wanted: tuple[str, ...], limits: Limits) -> tuple[Workshop | None, list[Rung]]:
    """The first of the wanted rungs that holds when it is tried, and those that did not."""
    if not hasattr(os, "fork"):
        tried = [Rung(name, "this system has no such isolation") for name in wanted if name != "none"]
        return (SpawningWorkshop(limits) if "none" in wanted else None), tried
    try:
        workshop = ForkingWorkshop(limits)
    except StudentDied as died:
        return None, [Rung(name, str(died)) for name in wanted]
    tried = []
    try:
        for name in wanted:
            why_not = "this system has no such isolation"
            for way in _ways(name):
                why_not = _try(workshop, way)
                if not why_not:
                    return workshop, tried
            tried.append(Rung(name, why_not))
    except BaseException:
        workshop.close()
        raise
    workshop.close()
    return None, tried


def _ways(name: str) -> list[Way]:
    """How a rung can be built here, best first."""
    root = os.name == "posix" and os.geteuid() == 0
    if name != "none" and sys.platform != "linux":
        return []
    if name == "namespaces":
        shared = Way(name, own_user_namespace=True)
        return [Way(name, own_user=True), shared] if root else [shared]
    return [Way(name, own_user=True), Way(name)] if root and sys.platform == "linux" else [Way(name)]


def _try(workshop: ForkingWorkshop, way: Way) -> str:
    """Stand on a rung and run code there that looks around; why it does not hold, or nothing."""
    with bench_folder() as folder, bench_folder() as outside:
        canary = outside / "canary"
        canary.write_text("not for students", encoding="utf-8")
        try:
            workshop.stand_on(way)
            student = workshop.start(folder)
        except (StudentDied, SandboxError) as error:
            return str(error)
        try:
            ran = student.run(_PROBE.format(canary=str(canary)))
            seen, broken = student.value("seen").value, student.value("broken").value
        except StudentDied as error:
            return str(error)
        finally:
            student.close()
    if not ran.ok or broken:
        return f"a trial failed ({broken or ran.error})"
    return "the files of this machine stay in sight" if seen is not False and way.rung != "none" else ""
