"""The grader's side of the judge's processes: calls with limits, and the student processes that they ask for."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from threading import Event, Lock
from typing import Any, TypeVar

from autograder.batch.judge_messages import (
    Call,
    End,
    Failed,
    Problem,
    Returned,
    Start,
    receive_message,
    send_message,
)
from autograder.batch.judge_worker import CPU_SECONDS
from autograder.sandbox.isolation import Limits, MachineError, ProcessLauncher, StudentProcess

Result = TypeVar("Result")

WALL_SECONDS = 600.0
"""Time of one call besides the time of the student's processes; a call that waits uses no processor time."""

_STUDENT_RUNS = 3  # in a row: the notebook, its replays, and the questions judged at the end
_END_SECONDS = 2.0
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class JudgeError(Exception):
    """A hand-in that could not be judged within the limits: the reason, and `details` for the instructor."""

    def __init__(self, reason: str, details: str = "") -> None:
        super().__init__(reason)
        self.details = details


class JudgePool:
    """The judge's processes of one grading run, each used by one thread at a time."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._idle: list[JudgeProcess] = []
        self._busy: list[JudgeProcess] = []
        self._closed = Event()

    @contextlib.contextmanager
    def borrow(self) -> Iterator["JudgeProcess"]:
        """A process that no other thread uses."""
        with self._lock:
            if self._closed.is_set():
                raise CancelledError
            judge = self._idle.pop() if self._idle else JudgeProcess()
            self._busy.append(judge)
        try:
            yield judge
        finally:
            with self._lock:
                self._busy.remove(judge)
                self._idle.append(judge)
                if self._closed.is_set():
                    judge.end()

    def close(self) -> None:
        """End all processes; calls at work raise `CancelledError`."""
        with self._lock:
            self._closed.set()
            for judge in self._busy:
                judge.cancel()
            for judge in self._idle:
                judge.end()


class JudgeProcess:
    """One of the judge's processes; it starts with the first call, and again after a call that ended it."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None
        self._students: dict[int, StudentProcess] = {}
        self._cancelled = False

    def call(
        self,
        function: Callable[..., Result],
        *arguments: Any,
        launcher: ProcessLauncher | None = None,
        cpu_seconds: float = CPU_SECONDS,
    ) -> Result:
        """Call a function in the process.

        Parameters
        ----------
        function : callable
            At the top level of its module, as are all classes of its arguments and of its value.
        *arguments
        launcher : ProcessLauncher, optional
            Passed to the function as its last argument.
        cpu_seconds : float
            Processor time of the call.

        Raises
        ------
        JudgeError
            If the function raises an error or exceeds a limit; the process then has ended, or is as good as new.
        MachineError
            If this machine cannot start the process, or one of the student's.
        """
        if not hasattr(socket, "send_fds"):  # Windows: in this process, and without limits
            return function(*arguments, *(() if launcher is None else (launcher,)))
        limits = Limits() if launcher is None else launcher.limits
        wall = WALL_SECONDS + (0 if launcher is None else _STUDENT_RUNS * limits.submission_seconds)
        deadline = time.monotonic() + wall
        control = self._opened()
        try:
            message = Call(function, arguments, None if launcher is None else launcher.level, limits, cpu_seconds)
            send_message(control, message)
            while True:
                control.settimeout(max(deadline - time.monotonic(), 0.01))
                reply = receive_message(control)
                if isinstance(reply, Returned):
                    value: Result = reply.value
                    return value
                if isinstance(reply, Failed):
                    raise JudgeError(reply.reason, reply.details)
                if isinstance(reply, Problem):
                    raise MachineError(reply.text)
                assert launcher is not None
                self._serve(control, reply, launcher)
        except TimeoutError:
            self.end()
            raise JudgeError(f"it takes longer than {wall:g} s") from None
        except (EOFError, OSError):
            raise self._ended_early(cpu_seconds) from None
        finally:
            for student in self._students.values():  # of a call that ended before they did
                student.close()
            self._students.clear()

    def cancel(self) -> None:
        """End the process for good from another thread; the call at work raises `CancelledError`."""
        self._cancelled = True
        process = self._process
        if process is not None:
            process.kill()

    def end(self) -> int:
        """End the process and return its exit status; the next call starts another one."""
        process, control = self._process, self._control
        self._process = self._control = None
        if control is not None:
            control.close()
        if process is None:
            return 0
        with contextlib.suppress(subprocess.TimeoutExpired):
            return process.wait(timeout=_END_SECONDS)
        process.kill()
        return process.wait()

    def _serve(self, control: socket.socket, request: Start | End, launcher: ProcessLauncher) -> None:
        if isinstance(request, End):
            send_message(control, self._students.pop(request.key).close())
            return
        try:
            student = launcher.start(request.folder)
        except MachineError as error:
            send_message(control, Problem(str(error)))
            return
        key = id(student)
        self._students[key] = student
        send_message(control, key)
        socket.send_fds(control, [b"."], [student.channel.fileno()])
        student.channel.close()  # the judge has its own copy

    def _opened(self) -> socket.socket:
        if self._cancelled:
            raise CancelledError
        if self._control is not None:
            return self._control
        control, theirs = socket.socketpair()
        with theirs:
            try:
                self._process = subprocess.Popen(
                    [sys.executable, "-P", "-m", "autograder.batch.judge_worker"],
                    stdin=theirs.fileno(),
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                    env=dict.fromkeys(_THREADS, "1") | dict(os.environ),
                    start_new_session=True,
                )
            except OSError as error:
                control.close()
                raise MachineError(f"the judge's process did not start: {error.strerror}") from None
        self._control = control
        return control

    def _ended_early(self, cpu_seconds: float) -> Exception:
        """The error to raise for a process that ended during a call."""
        status = self.end()
        if self._cancelled:
            return CancelledError()
        if status == -signal.SIGXCPU:
            return JudgeError(f"it takes more than {cpu_seconds:g} s of processor time")
        if status == -signal.SIGKILL:  # by the system, which ran out of memory, or by somebody
            return MachineError("the judge's process was killed")
        return JudgeError("it ends the judge's process", f"exit status {status}")
