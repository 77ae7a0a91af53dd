"""The process of `labsid submit` that runs a notebook: what grading refuses is refused, within the limits of grading.

What a cell opens outside of the notebook's folder, where grading has nothing, is listed.
"""

import importlib
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib.util import source_from_cache
from typing import Any

from labsid.checks.time_limit import CPU_SECONDS, FILE_BYTES, MEMORY_BYTES, OPEN_FILES, THREADS

_AT_START_BYTES = 600 * 1024**2  # address space of a student's process at its start, of which MEMORY_BYTES is the limit
_KERNEL_FILES = 8  # that a kernel opens after its start, more than a student's process has open at grading
_PROGRAMS = ("subprocess.", "os.system", "os.exec", "os.posix_spawn", "os.spawn", "os.fork", "os.startfile", "pty.")
_NETWORK = (
    "socket.connect",
    "socket.bind",
    "socket.getaddrinfo",
    "socket.gethostby",
    "socket.sendto",
    "socket.sendmsg",
)
_SYSTEM = "/usr /etc /proc /sys /dev /lib /lib64 /opt /nix /var /System /Library"
_SYSTEM_VARIABLES = ("SYSTEMROOT", "PROGRAMFILES")  # of Windows: where its folders are
_NO_DATA = (".ttf", ".otf", ".ttc", ".afm", ".pfb", ".dfont", ".ipynb")  # fonts, and the notebook itself
_MOST_FRAMES = 100  # between a cell and the file that it opens

_ELSEWHERE: dict[str, None] = {}


def limit_process(variables: Mapping[str, object]) -> None:
    """Refuse programs, other processes and the network; limit memory, files, threads and time, where possible.

    Parameters
    ----------
    variables : mapping
        The notebook's: the global names of its cells.
    """
    sys.addaudithook(_refuse)
    sys.addaudithook(_note_files_elsewhere(variables))
    _refuse_semaphores()
    _limit_threads()
    with suppress(OSError, ValueError):  # not on this system
        with open("/proc/self/statm", encoding="ascii") as file:
            size = int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
        _limit("RLIMIT_AS", size + MEMORY_BYTES - _AT_START_BYTES)
    with suppress(OSError):
        _limit("RLIMIT_NOFILE", len(os.listdir("/dev/fd")) + OPEN_FILES + _KERNEL_FILES)
    _limit("RLIMIT_FSIZE", FILE_BYTES)
    _limit("RLIMIT_CPU", int(time.process_time()) + CPU_SECONDS)


def files_elsewhere() -> list[str]:
    """The files that cells have opened, or imported, outside of their folder and of what comes with Python."""
    return list(_ELSEWHERE)


def _limit(name: str, value: int) -> None:
    with suppress(ImportError, AttributeError, OSError, ValueError):  # not on this system
        resource = importlib.import_module("resource")
        kind = getattr(resource, name)
        soft, hard = resource.getrlimit(kind)
        resource.setrlimit(kind, (value if soft == resource.RLIM_INFINITY else min(value, soft), hard))


def _limit_threads() -> None:
    most, usual = threading.active_count() + THREADS, threading.Thread.start

    def start(thread: threading.Thread) -> None:
        if threading.active_count() >= most:
            raise RuntimeError("can't start new thread")
        usual(thread)

    threading.Thread.start = start  # type: ignore[method-assign,assignment]


def _note_files_elsewhere(variables: Mapping[str, object]) -> Callable[[str, tuple[Any, ...]], None]:
    loaded = (getattr(module, "__file__", None) for module in list(sys.modules.values()))
    packages = {os.path.dirname(path) for path in loaded if path}  # installed elsewhere, and labsid itself
    own = (os.getcwd(), tempfile.gettempdir(), sys.prefix, sys.base_prefix, *filter(None, sys.path), *packages)
    system = (*_SYSTEM.split(), *(os.environ[name] for name in _SYSTEM_VARIABLES if name in os.environ))
    roots = tuple({os.path.join(os.path.realpath(folder), "") for folder in (*own, *system)})

    def note(event: str, arguments: tuple[Any, ...]) -> None:
        if event != "open" or type(arguments[0]) not in (str, bytes):
            return
        with suppress(ValueError, OSError):  # no name of a file, as it will be told
            path = os.path.realpath(os.fsdecode(arguments[0]))
            path = source_from_cache(path) if path.endswith(".pyc") else path
            is_hidden = f"{os.sep}." in path or f"{os.sep}__pycache__{os.sep}" in path  # settings and caches
            is_needed = is_hidden or f"{path}{os.sep}".startswith(roots) or path.lower().endswith(_NO_DATA)
            if not is_needed and _is_by_a_cell(variables):
                _ELSEWHERE.setdefault(path)

    return note


def _is_by_a_cell(variables: Mapping[str, object]) -> bool:
    frame = sys._getframe(1)
    for _ in range(_MOST_FRAMES):
        if frame.f_globals is variables:
            return True
        if frame.f_back is None:
            break
        frame = frame.f_back
    return False


def _refuse(event: str, arguments: tuple[Any, ...]) -> None:
    if not event.startswith((*_PROGRAMS, *_NETWORK)):
        return
    if event.startswith(_NETWORK) and threading.current_thread() is not threading.main_thread():
        return  # the kernel's own
    what = "there is no network" if event.startswith(_NETWORK) else "no program and no other process can be started"
    raise PermissionError(f"while a notebook is graded {what}")


def _refuse_semaphores() -> None:
    """Locks between processes, which a sandbox has no memory for."""
    try:
        inner = importlib.import_module("_multiprocessing")
        usual = inner.SemLock
    except (ImportError, AttributeError):  # not on this system
        return

    class SemLock(usual):  # type: ignore[misc,valid-type]
        def __new__(cls, *_: Any) -> Any:
            raise PermissionError("while a notebook is graded no other process can be started")

    inner.SemLock = SemLock  # type: ignore[attr-defined]
