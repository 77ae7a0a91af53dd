"""Attempts to escape from a student process, and which of them succeed where student code is not isolated."""

from dataclasses import dataclass

from autograder.sandbox.confine import can_confine_signals, make_syscall_filter

ORPHAN = "labsid-orphan"
_NAME_ORPHAN = f"import ctypes\nctypes.CDLL(None).prctl(15, b'{ORPHAN}', 0, 0, 0)\n"


@dataclass(frozen=True, slots=True)
class Escape:
    """An attempt to escape from a student process.

    Attributes
    ----------
    name : str
    code : str
        Sets `escaped` to whether the attempt succeeded; an error means that it failed. `targets` maps the name of each
        target to its path, address or process ID.
    """

    name: str
    code: str


_PAST_THE_GUARDS = (
    "import sys\nfrom importlib import import_module\n"
    "sys.meta_path[:] = [one for one in sys.meta_path if 'Reference' not in type(one).__name__]\n"
)
"""Without the finder that refuses the reference, and by a function that the rules of imports in cells do not see."""

TCP = Escape(
    "connect to loopback (TCP)", "import socket\nsocket.create_connection(targets['tcp'], 2).close()\nescaped = True"
)

ESCAPES = (
    Escape("read the course", "escaped = open(targets['course']).read() != ''"),
    Escape("read another submission", "escaped = open(targets['submission']).read() != ''"),
    Escape("read the gradebook", "escaped = open(targets['gradebook']).read() != ''"),
    Escape("read the reference's sources", "escaped = 'def ' in open(targets['reference']).read()"),
    Escape(
        "import the reference",
        _PAST_THE_GUARDS + "import_module('labsid.lab.arx')\nescaped = True",
    ),
    Escape(
        "find the reference in memory",
        "import gc\n"
        "gc.unfreeze()\n"  # or what the parent held when it froze its objects is not listed
        "reference = ('labsid.lab.', 'labsid.checks.assignments')\n"
        "escaped = any(str(getattr(it, '__module__', '')).startswith(reference)\n"
        "              for it in gc.get_objects() if callable(it))",
    ),
    Escape(
        "import the rig with what is withheld",
        _PAST_THE_GUARDS + "import_module('labsid.rig.switchable.withheld')\nescaped = True",
    ),
    Escape(
        "draw the results with labsid's figures",
        _PAST_THE_GUARDS + "escaped = callable(import_module('labsid.plots').figure_7)",
    ),
    Escape("write outside", "open(targets['outside'], 'w').write('was here')\nescaped = True"),
    Escape("change the gradebook", "open(targets['gradebook'], 'a').write('5')\nescaped = True"),
    Escape(
        "change the mode of another submission",
        "import os\nos.chmod(targets['submission'], 0o640)\n"
        "escaped = os.stat(targets['submission']).st_mode & 0o777 == 0o640",
    ),
    Escape(
        "change the time of another submission",
        "import os\nos.utime(targets['submission'], (1, 1))\nescaped = os.stat(targets['submission']).st_mtime == 1",
    ),
    Escape(
        "set an attribute of another submission",
        "import os\nos.setxattr(targets['submission'], 'user.labsid', b'1')\nescaped = True",
    ),
    Escape("leave a file for the next", "open('/tmp/labsid-left-behind', 'w').write('5')\nescaped = True"),
    TCP,
    Escape(
        "send to loopback (UDP)",
        "import socket\nsocket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b'x', targets['udp'])\nescaped = True",
    ),
    Escape(
        "connect to a local service",
        "import socket\nsocket.socket(socket.AF_UNIX).connect(targets['unix'])\nescaped = True",
    ),
    Escape(
        "see other processes",
        "import os, subprocess\n"
        "seen = os.listdir('/proc') if os.path.isdir('/proc') else subprocess.check_output(['ps', '-ax'], text=True)\n"
        "escaped = str(targets['grader']) in seen and os.path.exists('/proc/%d/cmdline' % targets['grader'])",
    ),
    Escape("signal the grader", "import os\nos.kill(targets['grader'], 0)\nescaped = True"),
    Escape("signal the parent", "import os\nos.kill(targets['parent'], 0)\nescaped = True"),
    Escape("signal another process", "import os\nos.kill(targets['other'], 0)\nescaped = True"),
    Escape("read the grader's memory", "open('/proc/%d/mem' % targets['grader'], 'rb').close()\nescaped = True"),
    Escape("read the parent's memory", "open('/proc/%d/mem' % targets['parent'], 'rb').close()\nescaped = True"),
    Escape(
        "keep a process alive",
        "import os, time\nif os.fork() == 0:\n    os.setsid()\n    if os.fork() == 0:\n"
        + "".join(f"        {line}\n" for line in _NAME_ORPHAN.splitlines())
        + "        time.sleep(60)\n    os._exit(0)\ntime.sleep(0.2)\nescaped = None",
    ),
    Escape("allocate 2 GB", "block = bytearray(2 << 30)\nescaped = True"),
    Escape(
        "start 200 processes",
        "import os, time\nchildren = []\ntry:\n    for _ in range(200):\n        pid = os.fork()\n"
        "        if pid == 0:\n            time.sleep(20)\n            os._exit(0)\n        children.append(pid)\n"
        "finally:\n    for pid in children:\n        os.kill(pid, 9)\nescaped = True",
    ),
    Escape("write a file of 12 MB", "open('large', 'wb').write(bytes(12 << 20))\nescaped = True"),
    Escape(
        "fill the disk with 32 MB",
        "import time\nfor i in range(8):\n    with open(str(i), 'wb') as file:\n        file.write(bytes(4 << 20))\n"
        "    time.sleep(0.2)\nescaped = True",
    ),
    Escape(
        "make a namespace of its own",
        "import ctypes\nescaped = ctypes.CDLL(None).unshare(0x10000000) == 0",
    ),
)

OPEN_WITHOUT_ISOLATION = (
    "read the course",
    "read another submission",
    "read the gradebook",
    "read the reference's sources",
    "import the reference",
    "import the rig with what is withheld",
    "draw the results with labsid's figures",
    "write outside",
    "change the gradebook",
    "leave a file for the next",
    "see other processes",
)
"""What nothing prevents on the level "none" if Linux filters system calls. Root gives each process a user of its own,
which prevents some of it."""

OPEN_WITHOUT_FILTER = (
    "change the mode of another submission",
    "change the time of another submission",
    "set an attribute of another submission",
    "connect to loopback (TCP)",
    "send to loopback (UDP)",
    "connect to a local service",
    "signal the grader",
    "signal the parent",
    "signal another process",
)
"""What else nothing prevents on a system that filters no system calls."""


def open_escapes(level: str) -> tuple[str, ...]:
    """The escapes that can succeed on a level; ``labsid course doctor`` tries them, and a grading run names them."""
    if level != "none":
        return ()
    if make_syscall_filter(()) is None:
        return (*OPEN_WITHOUT_ISOLATION, *OPEN_WITHOUT_FILTER)
    return OPEN_WITHOUT_ISOLATION if can_confine_signals() else (*OPEN_WITHOUT_ISOLATION, "signal another process")
