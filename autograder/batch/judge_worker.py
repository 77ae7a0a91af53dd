"""The judge's process: works on one hand-in at a time, within limits of processor time and memory.

It is trusted, and holds checks and right values; what it reads is not. The grader may end it at any moment, so whatever
a hand-in makes it do costs that hand-in alone. It talks to the grader over a Unix socket on standard input, in pickled
messages, as both trust each other. The grader starts the student's processes and passes on their channels.
"""

import errno
import os
import pickle
import signal
import socket
from pathlib import Path
from threading import Lock
from typing import Any

from autograder.batch.judge_messages import (
    Call,
    End,
    Failed,
    Problem,
    Returned,
    Start,
    receive_message,
    send_bytes,
    send_message,
)
from autograder.sandbox.confine import hide_memory
from autograder.sandbox.limits import Limits
from autograder.sandbox.student_process import MachineError, StudentProcess

CPU_SECONDS = 60
"""Processor time of one call; an honest hand-in with all its figures takes about 1 s."""

MEMORY_BYTES = 2 * 1024**3
"""Address space beyond what the process has at the start of a call: as much as a student's process has in all."""

MAX_RESULT_BYTES = 256 * 1024**2
"""Size of a pickled result; outputs and figures of an honest hand-in take less than 1 MB."""

_MACHINE_ERRORS = (errno.ENOSPC, errno.EDQUOT, errno.EMFILE, errno.ENFILE, errno.EAGAIN, errno.ENOMEM, errno.EIO)


class RemoteLauncher:
    """Starts student processes through the grader; its threads take turns, each from its request to the reply."""

    def __init__(self, control: socket.socket, level: str, limits: Limits) -> None:
        self._control = control
        self._turn = Lock()
        self.level = level
        self.limits = limits

    def start(self, folder: Path) -> StudentProcess:
        """Start a process with a copy of the files in `folder` in its work folder."""
        with self._turn:
            key = self._ask(Start(folder))
            _, descriptors, _, _ = socket.recv_fds(self._control, 1, 1)
        return StudentProcess(socket.socket(fileno=descriptors[0]), self.limits, lambda: self._end(key))

    def close(self) -> None:
        """Do nothing: the grader owns the processes."""

    def _end(self, key: int) -> Any:
        with self._turn:
            return self._ask(End(key))

    def _ask(self, request: object) -> Any:
        send_message(self._control, request)
        reply = receive_message(self._control)
        if isinstance(reply, Problem):
            raise MachineError(reply.text)
        return reply


def main() -> None:
    """Answer calls until the grader closes the connection."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the grader decides when this process ends
    hide_memory()
    with socket.socket(fileno=os.dup(0)) as control:
        while True:
            try:
                send_bytes(control, _answer(control, receive_message(control)))
            except (EOFError, OSError):
                return


def _answer(control: socket.socket, call: Call) -> bytes:
    """The pickled answer to a call; it is pickled within the limits too."""
    arguments = call.arguments
    if call.level is not None:
        arguments += (RemoteLauncher(control, call.level, call.limits),)
    _limit_resources(call.cpu_seconds)
    answer: Failed | Problem
    try:
        payload = pickle.dumps(Returned(call.function(*arguments)), protocol=pickle.HIGHEST_PROTOCOL)
        if len(payload) <= MAX_RESULT_BYTES:
            return payload
        answer = Failed(f"its result is larger than {MAX_RESULT_BYTES // 1024**2} MB")
    except MachineError as error:
        answer = Problem(str(error))
    except OSError as error:
        if error.errno not in _MACHINE_ERRORS:
            answer = Failed(f"it stops with {type(error).__name__}", str(error)[:500])
        else:
            answer = Problem(str(error.strerror))
    except MemoryError:
        answer = Failed(f"it takes more than {MEMORY_BYTES / 1024**3:g} GB of memory")
    except Exception as error:
        answer = Failed(f"it stops with {type(error).__name__}", str(error)[:500])
    return pickle.dumps(answer)


def _limit_resources(cpu_seconds: float) -> None:
    """Limit the processor time and the memory of the next call; a second more of time tells which limit it was."""
    import resource

    used = resource.getrusage(resource.RUSAGE_SELF)
    _set_soft(resource.RLIMIT_CPU, int(used.ru_utime + used.ru_stime + cpu_seconds) + 1)
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            size = int(file.read().split()[0]) * resource.getpagesize()
    except OSError:  # not on this system, which does not enforce the limit either
        return
    _set_soft(resource.RLIMIT_AS, size + MEMORY_BYTES)


def _set_soft(kind: int, value: int) -> None:
    import resource

    hard = resource.getrlimit(kind)[1]
    resource.setrlimit(kind, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))


if __name__ == "__main__":
    main()
