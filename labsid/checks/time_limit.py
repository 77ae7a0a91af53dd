"""Limits on students' cells and functions, the same in the notebook, in `labsid submit` and at grading."""

import contextlib
import signal
import threading
from collections.abc import Iterator
from typing import Any

CELL_SECONDS = 30.0
"""Longest run of one cell, in seconds."""

CALL_SECONDS = 10.0
"""Longest call of a student's function by a check, in seconds."""

SUBMISSION_SECONDS = 300.0
"""Longest run of all cells of a notebook, in seconds."""

MEMORY_BYTES = 2 * 1024**3
"""Address space of the process that runs a notebook."""

FILE_BYTES, DISK_BYTES = 64 * 1024**2, 128 * 1024**2
"""Size of one file that a notebook writes, and of all of them."""

OPEN_FILES = 256
"""Files that are open at a time in the process that runs a notebook."""

THREADS = 64
"""Threads and processes beside the first."""

CPU_SECONDS = 300
"""Processor time of the process that runs a notebook."""

MOST_OWN_CELLS = 1000
"""Cells of the student's, answers among them, that are run in one notebook."""

NOTEBOOK_BYTES = 50 * 1024**2
"""Size of a notebook file that is collected and read."""

AGAIN_SECONDS = 0.5
"""Time between one `OutOfTime` and the next: Python drops an exception that is raised while it collects garbage."""


_FREE = (signal.SIG_DFL, signal.SIG_IGN)


class OutOfTime(BaseException):
    """A call took longer than its limit; not an `Exception`, which the function may catch."""


def can_limit_time() -> bool:
    """Whether `limit_time` has an effect here."""
    is_first = threading.current_thread() is threading.main_thread()
    return hasattr(signal, "setitimer") and is_first and signal.getsignal(signal.SIGALRM) in _FREE


@contextlib.contextmanager
def limit_time(seconds: float) -> Iterator[None]:
    """Raise `OutOfTime` in the block after so many seconds.

    Without effect where the system has no timer signal (Windows), in any thread but the first, and while another
    program uses that signal.
    """
    if not can_limit_time():
        yield
        return

    def stop(number: int, frame: Any) -> None:
        raise OutOfTime

    previous = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN_SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, previous)
