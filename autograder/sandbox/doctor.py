"""``labsid course doctor``: attempts known sandbox escapes at every isolation level of this machine.

Each attempt is code that a submission could contain, run in its own student process. Its targets are created for the
attempt (a course, a gradebook, another submission, listeners on loopback), so no real data is at risk.
"""

import contextlib
import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import labsid
from autograder.sandbox.escapes import ESCAPES, ORPHAN, Escape
from autograder.sandbox.isolation import (
    Limits,
    ProcessLauncher,
    StudentProcessError,
    launchers_by_level,
    temporary_workdir,
)

SCHEMA = "labsid.doctor/1"
LIMITS = Limits(
    cell_seconds=20, memory_bytes=1536 * 1024**2, file_bytes=8 * 1024**2, disk_bytes=16 * 1024**2, processes=32
)
"""Low, so that a successful attempt does no harm."""


@dataclass(frozen=True, slots=True)
class LevelReport:
    """The result of all attempts at one isolation level.

    Attributes
    ----------
    level : str
    problem : str
        Why the level is unavailable; empty if it is available.
    blocked : mapping
        Whether the attempt failed, by its name.
    """

    level: str
    problem: str
    blocked: dict[str, bool]


def attempt_escapes() -> Iterator[LevelReport]:
    """Attempt every escape at every isolation level, strongest first; yields the report of each level."""
    for level, launcher in launchers_by_level(LIMITS):
        blocked = {} if launcher is None else {escape.name: is_blocked(launcher, escape) for escape in ESCAPES}
        yield LevelReport(level.name, level.problem, blocked)


def reports_text(reports: list[LevelReport]) -> str:
    """Format a table with a line for each escape and a column for each level."""
    width = max(len(escape.name) for escape in ESCAPES)
    lines = [" " * width + "".join(f"  {report.level:>10}" for report in reports)]
    for escape in ESCAPES:
        cells = ["-" if escape.name not in one.blocked else _WORDS[one.blocked[escape.name]] for one in reports]
        lines.append(f"{escape.name:<{width}}" + "".join(f"  {cell:>10}" for cell in cells))
    lines.append("")
    lines += [f"{one.level} is unavailable: {one.problem}" for one in reports if one.problem]
    best = next((one.level for one in reports if not one.problem), "nothing, as no student process starts")
    lines.append(f"Grading with --isolation best uses: {best}")
    return "\n".join(lines)


def reports_json(reports: list[LevelReport]) -> str:
    """Format the reports as JSON."""
    levels = {one.level: {"why_not": one.problem, "holds": one.blocked} for one in reports}
    return json.dumps({"schema": SCHEMA, "rungs": levels}, indent=2) + "\n"


_WORDS = {True: "blocked", False: "OPEN"}


def is_blocked(launcher: ProcessLauncher, escape: Escape) -> bool:
    """Whether the launcher's isolation blocks an escape."""
    with _make_targets(launcher, escape) as targets, temporary_workdir() as folder:
        student = launcher.start(folder)
        try:
            student.run(f"escaped = False\ntargets = {targets!r}")
            student.run(escape.code)
            escaped = student.value("escaped").value
        except StudentProcessError:
            escaped = False
        finally:
            student.close()
        if escape.name == "keep a process alive":
            return not _orphan_runs()
        if escape.name == "leave a file for the next":
            return not _next_submission_sees(launcher, "/tmp/labsid-left-behind")
        return escaped is not True


def _next_submission_sees(launcher: ProcessLauncher, path: str) -> bool:
    """Whether the next submission sees the file at `path`."""
    with temporary_workdir() as folder:
        student = launcher.start(folder)
        try:
            student.run(f"import os\nfound = os.path.exists({path!r})")
            return student.value("found").value is True
        finally:
            student.close()
            with contextlib.suppress(OSError):
                os.remove(path)


def _orphan_runs() -> bool:
    """Whether the process that a submission left behind still runs after 2 s; kills it."""
    for _ in range(20):
        orphans = []
        with contextlib.suppress(OSError):
            for name in os.listdir("/proc"):
                if name.isdigit():
                    with contextlib.suppress(OSError):
                        if Path(f"/proc/{name}/comm").read_text(encoding="utf-8").strip() == ORPHAN:
                            orphans.append(int(name))
        if not orphans:
            return False
        time.sleep(0.1)
    for pid in orphans:
        with contextlib.suppress(OSError):
            os.kill(pid, 9)
    return True


@contextlib.contextmanager
def _make_targets(launcher: ProcessLauncher, escape: Escape) -> Iterator[dict[str, object]]:
    """Create the targets of an attempt; the process, which takes longest to start, if it has one."""
    with temporary_workdir() as folder, contextlib.ExitStack() as listeners:
        targets: dict[str, object] = {
            "grader": os.getpid(),
            "parent": getattr(launcher, "fork_server_pid", os.getpid()),
        }
        for name in ("course", "submission", "gradebook"):
            path = folder / name
            path.write_text("not for students", encoding="utf-8")
            targets[name] = str(path)
        targets["outside"] = str(folder / "outside")
        targets["reference"] = str(Path(labsid.__file__).parent / "lab" / "arx.py")
        tcp = listeners.enter_context(socket.create_server(("127.0.0.1", 0)))
        udp = listeners.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        udp.bind(("127.0.0.1", 0))
        if "targets['other']" in escape.code:
            targets["other"] = listeners.enter_context(_other_process()).pid
        targets |= {"tcp": tcp.getsockname(), "udp": udp.getsockname(), "unix": str(folder / "service")}
        if hasattr(socket, "AF_UNIX"):
            unix = listeners.enter_context(socket.socket(socket.AF_UNIX))
            unix.bind(str(folder / "service"))
            unix.listen()
        yield targets


@contextlib.contextmanager
def _other_process() -> Iterator["subprocess.Popen[bytes]"]:
    """A process of the same user, such as an editor of the instructor's; it waits for an end of file."""
    waiting = [sys.executable, "-S", "-c", "import sys; sys.stdin.read()"]
    with subprocess.Popen(waiting, stdin=subprocess.PIPE) as process:
        yield process
