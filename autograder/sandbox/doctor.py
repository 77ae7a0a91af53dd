"""``labsid course doctor``: tries each way out of a student's process on this machine, on every level it has.

Each trial is code as a submission could hold it, run in a process of its own. What it is after is made for the trial (a
course, a gradebook, another submission, listeners on loopback), so nothing of value is touched.
"""

import contextlib
import json
import os
import socket
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import labsid
from autograder.sandbox.isolation import (
    LEVELS,
    IsolationError,
    Limits,
    ProcessLauncher,
    StudentProcessError,
    open_launcher,
    temporary_workdir,
)

SCHEMA = "labsid.doctor/1"
LIMITS = Limits(
    cell_seconds=20, memory_bytes=1536 * 1024**2, file_bytes=8 * 1024**2, disk_bytes=16 * 1024**2, processes=32
)
"""Tight, so that a trial that gets out does no harm."""

_ORPHAN = "labsid-orphan"
_FIND_ORPHAN = f"import ctypes\nctypes.CDLL(None).prctl(15, b'{_ORPHAN}', 0, 0, 0)\n"


@dataclass(frozen=True, slots=True)
class Escape:
    """A way out.

    Attributes
    ----------
    name : str
    code : str
        Sets `got` to whether it got out; `there` is what was made for it, by name. An error means that it did not.
    """

    name: str
    code: str


@dataclass(frozen=True, slots=True)
class Checkup:
    """What was found on one level.

    Attributes
    ----------
    level : str
    why_not : str
        Why this machine does not have it; empty where it has.
    holds : mapping
        Whether it holds, by name of the escape.
    """

    level: str
    why_not: str
    holds: dict[str, bool]


TCP = Escape(
    "connect to loopback (TCP)", "import socket\nsocket.create_connection(there['tcp'], 2).close()\ngot = True"
)

ESCAPES = (
    Escape("read the course", "got = open(there['course']).read() != ''"),
    Escape("read another submission", "got = open(there['submission']).read() != ''"),
    Escape("read the gradebook", "got = open(there['gradebook']).read() != ''"),
    Escape("read the reference's sources", "got = 'def ' in open(there['reference']).read()"),
    Escape(
        "import the reference",
        "import sys\nsys.meta_path[:] = [one for one in sys.meta_path if 'Reference' not in type(one).__name__]\n"
        "import labsid.lab.arx\ngot = True",
    ),
    Escape(
        "find the reference in memory",
        "import gc\n"
        "got = any(getattr(it, '__module__', None) in ('labsid.lab.arx', 'labsid.lab.sinusoid', 'labsid.lab.offset')\n"
        "          or 'assignments' in str(getattr(it, '__module__', '')) and 'labsid' in it.__module__\n"
        "          for it in gc.get_objects() if callable(it))",
    ),
    Escape("write outside", "open(there['outside'], 'w').write('was here')\ngot = True"),
    Escape("change the gradebook", "open(there['gradebook'], 'a').write('5')\ngot = True"),
    Escape("leave a file for the next", "open('/tmp/labsid-left-behind', 'w').write('5')\ngot = True"),
    TCP,
    Escape(
        "send to loopback (UDP)",
        "import socket\nsocket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b'x', there['udp'])\ngot = True",
    ),
    Escape(
        "connect to a local service",
        "import socket\nsocket.socket(socket.AF_UNIX).connect(there['unix'])\ngot = True",
    ),
    Escape(
        "see other processes",
        "import os, subprocess\n"
        "seen = os.listdir('/proc') if os.path.isdir('/proc') else subprocess.check_output(['ps', '-ax'], text=True)\n"
        "got = str(there['grader']) in seen and os.path.exists('/proc/%d/cmdline' % there['grader'])",
    ),
    Escape("signal the grader", "import os\nos.kill(there['grader'], 0)\ngot = True"),
    Escape("signal the parent", "import os\nos.kill(there['parent'], 0)\ngot = True"),
    Escape("read the parent's memory", "open('/proc/%d/mem' % there['parent'], 'rb').close()\ngot = True"),
    Escape(
        "keep a process alive",
        "import os, time\nif os.fork() == 0:\n    os.setsid()\n    if os.fork() == 0:\n"
        + "".join(f"        {line}\n" for line in _FIND_ORPHAN.splitlines())
        + "        time.sleep(60)\n    os._exit(0)\ntime.sleep(0.2)\ngot = None",
    ),
    Escape("allocate 2 GB", "block = bytearray(2 << 30)\ngot = True"),
    Escape(
        "start 200 processes",
        "import os, time\nchildren = []\ntry:\n    for _ in range(200):\n        pid = os.fork()\n"
        "        if pid == 0:\n            time.sleep(20)\n            os._exit(0)\n        children.append(pid)\n"
        "finally:\n    for pid in children:\n        os.kill(pid, 9)\ngot = True",
    ),
    Escape("write a file of 12 MB", "open('large', 'wb').write(bytes(12 << 20))\ngot = True"),
    Escape(
        "fill the disk with 32 MB",
        "import time\nfor i in range(8):\n    with open(str(i), 'wb') as file:\n        file.write(bytes(4 << 20))\n"
        "    time.sleep(0.2)\ngot = True",
    ),
    Escape(
        "make a namespace of its own",
        "import ctypes\ngot = ctypes.CDLL(None).unshare(0x10000000) == 0",
    ),
)


def examine() -> Iterator[Checkup]:
    """Try every escape on every level, strongest level first; yields what was found on each."""
    for level in LEVELS:
        try:
            with open_launcher(level, LIMITS) as launcher:
                yield Checkup(level, "", {escape.name: is_blocked(launcher, escape) for escape in ESCAPES})
        except IsolationError as error:
            yield Checkup(level, str(error), {})


def as_text(checkups: list[Checkup]) -> str:
    """A table: a line for each escape, a column for each level."""
    width = max(len(escape.name) for escape in ESCAPES)
    lines = [" " * width + "".join(f"  {checkup.level:>10}" for checkup in checkups)]
    for escape in ESCAPES:
        cells = ["-" if escape.name not in one.holds else _WORDS[one.holds[escape.name]] for one in checkups]
        lines.append(f"{escape.name:<{width}}" + "".join(f"  {cell:>10}" for cell in cells))
    lines.append("")
    lines += [f"{one.level} is not to be had here: {one.why_not}" for one in checkups if one.why_not]
    best = next((one.level for one in checkups if not one.why_not), "nothing: no student process starts here")
    lines.append(f"Grading with --isolation best stands on: {best}")
    return "\n".join(lines)


def as_json(checkups: list[Checkup]) -> str:
    """The same for programs."""
    levels = {one.level: {"why_not": one.why_not, "holds": one.holds} for one in checkups}
    return json.dumps({"schema": SCHEMA, "rungs": levels}, indent=2) + "\n"


_WORDS = {True: "holds", False: "OPEN"}


def is_blocked(launcher: ProcessLauncher, escape: Escape) -> bool:
    """Whether the launcher's isolation blocks an escape."""
    with _surroundings(launcher) as there, temporary_workdir() as folder:
        student = launcher.start(folder)
        try:
            student.run(f"got = False\nthere = {there!r}")
            student.run(escape.code)
            got = student.value("got").value
        except StudentProcessError:
            got = False
        finally:
            student.close()
        if escape.name == "keep a process alive":
            return not _orphan_lives()
        if escape.name == "leave a file for the next":
            return not _is_there(launcher, "/tmp/labsid-left-behind")
        return got is not True


def _is_there(launcher: ProcessLauncher, path: str) -> bool:
    """Whether the next submission sees a file."""
    with temporary_workdir() as folder:
        student = launcher.start(folder)
        try:
            student.run(f"import os\nthere = os.path.exists({path!r})")
            return student.value("there").value is True
        finally:
            student.close()
            with contextlib.suppress(OSError):
                os.remove(path)


def _orphan_lives() -> bool:
    """Whether the process that a submission left behind still runs, after the time that ending it may take."""
    for _ in range(20):
        found = []
        with contextlib.suppress(OSError):
            for name in os.listdir("/proc"):
                if name.isdigit():
                    with contextlib.suppress(OSError):
                        if Path(f"/proc/{name}/comm").read_text(encoding="utf-8").strip() == _ORPHAN:
                            found.append(int(name))
        if not found:
            return False
        time.sleep(0.1)
    for pid in found:
        with contextlib.suppress(OSError):
            os.kill(pid, 9)
    return True


@contextlib.contextmanager
def _surroundings(launcher: ProcessLauncher) -> Iterator[dict[str, object]]:
    """What an escape is after."""
    with temporary_workdir() as folder, contextlib.ExitStack() as open_now:
        there: dict[str, object] = {"grader": os.getpid(), "parent": getattr(launcher, "parent", os.getpid())}
        for name in ("course", "submission", "gradebook"):
            path = folder / name
            path.write_text("not for students", encoding="utf-8")
            there[name] = str(path)
        there["outside"] = str(folder / "outside")
        there["reference"] = str(Path(labsid.__file__).parent / "lab" / "arx.py")
        tcp = open_now.enter_context(socket.create_server(("127.0.0.1", 0)))
        udp = open_now.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        udp.bind(("127.0.0.1", 0))
        there |= {"tcp": tcp.getsockname(), "udp": udp.getsockname(), "unix": str(folder / "service")}
        if hasattr(socket, "AF_UNIX"):
            unix = open_now.enter_context(socket.socket(socket.AF_UNIX))
            unix.bind(str(folder / "service"))
            unix.listen()
        yield there
