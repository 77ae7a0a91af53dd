"""Where student code runs: one process a submission, apart from the judge, and how far it is held in.

`open_workshop` gives a `Workshop`; its `start` gives a `Student`, which runs cells and hands over values. Dying,
taking too long and breaking the channel are all `StudentDied`; the caller starts another one.
"""

import contextlib
import os
import secrets
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from autograder.channel import (
    MAX_OUTPUT_CHARACTERS,
    ChannelError,
    Gone,
    decode,
    decode_figures,
    encode,
    receive,
    send,
)
from labsid.checks.values import Value

RUNGS = ("none",)
"""Rungs of the ladder that this version can build, strongest first; "none" is a plain process with limits."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What one submission may use.

    Attributes
    ----------
    start_seconds, cell_seconds, call_seconds : float
        Time for the process to come up, for one cell, and for one answer (a value or a call of a function).
    memory_bytes, file_bytes : int
        Address space, and the size of any one file it writes.
    cpu_seconds : int
        Processor time of the whole submission.
    """

    start_seconds: float = 60.0
    cell_seconds: float = 30.0
    call_seconds: float = 10.0
    memory_bytes: int = 4 * 1024**3
    file_bytes: int = 64 * 1024**2
    cpu_seconds: int = 300

    def as_rlimits(self) -> dict[str, int]:
        """The limits that the operating system keeps."""
        return {
            "RLIMIT_AS": self.memory_bytes,
            "RLIMIT_FSIZE": self.file_bytes,
            "RLIMIT_CPU": self.cpu_seconds,
            "RLIMIT_CORE": 0,
        }


class StudentDied(Exception):
    """The student's process ended, hung, or sent what is no answer; `status` is that of GRADING.md."""

    def __init__(self, status: str, text: str) -> None:
        super().__init__(text)
        self.status = status


@dataclass(frozen=True, slots=True)
class Reply:
    """What came back: a value, or why there is none."""

    ok: bool
    value: Value = None
    error: Mapping[str, Any] | None = None
    stdout: str = ""
    figures: tuple[str, ...] = ()


class Student:
    """One student's process, spoken to over its channel."""

    def __init__(self, channel: socket.socket, limits: Limits, end: Any) -> None:
        self._channel = channel
        self._limits = limits
        self._end = end
        self._ended: int | None = None

    def run(self, source: str, figures: bool = False) -> Reply:
        """Run one cell; `figures` asks for pictures of what it drew."""
        return self._ask({"op": "run", "source": source, "figures": figures}, self._limits.cell_seconds)

    def value(self, name: str) -> Reply:
        """Ask for a variable."""
        return self._ask({"op": "value", "name": name}, self._limits.call_seconds)

    def call(self, name: str, *arguments: Value) -> Reply:
        """Call one of the student's functions."""
        encoded = [encode(argument) for argument in arguments]
        return self._ask({"op": "call", "name": name, "arguments": encoded}, self._limits.call_seconds)

    def set(self, values: Mapping[str, Value]) -> Reply:
        """Put values in the place of the student's own (error carried forward)."""
        encoded = {name: encode(value) for name, value in values.items()}
        return self._ask({"op": "set", "values": encoded}, self._limits.call_seconds)

    def close(self) -> int:
        """End the process and everything it started, once; return how it ended."""
        if self._ended is None:
            self._channel.close()
            self._ended = int(self._end())
        return self._ended

    def _ask(self, request: dict[str, Any], seconds: float) -> Reply:
        self._channel.settimeout(seconds)
        try:
            send(self._channel, request)
            return _read_reply(receive(self._channel))
        except TimeoutError:
            raise StudentDied("timeout", f"it took longer than {seconds:g} s") from None
        except Gone:
            status = self.close()
        except ChannelError as error:
            raise StudentDied("crashed", str(error)) from None
        if os.name == "posix" and status == -signal.SIGXCPU:
            raise StudentDied("limit", f"it used more than {self._limits.cpu_seconds} s of processor time")
        how = f"was ended by {signal.Signals(-status).name}" if status < 0 else f"ended with exit status {status}"
        raise StudentDied("crashed", f"its process {how}")


def _read_reply(message: dict[str, Any]) -> Reply:
    """A reply whose every part is of the kind, and of a size, that its reader relies on."""
    error = message.get("error")
    return Reply(
        ok=message.get("ok") is True,
        value=decode(message["value"]) if "value" in message else None,
        error={key: str(error[key])[:500] for key in ("kind", "text", "line") if error.get(key) is not None}
        if isinstance(error, dict)
        else None,
        stdout=str(message.get("stdout", ""))[:MAX_OUTPUT_CHARACTERS],
        figures=decode_figures(message.get("figures")),
    )


class Workshop(Protocol):
    """Something that starts students' processes."""

    @property
    def rung(self) -> str:
        """Which rung of the ladder it stands on, as written into every result."""

    def start(self, folder: Path) -> Student:
        """Start a process that works in `folder`."""

    def close(self) -> None:
        """End everything that was started."""


@contextlib.contextmanager
def open_workshop(isolation: str = "best", limits: Limits | None = None) -> Iterator[Workshop]:
    """Open the best workshop that this machine has.

    Parameters
    ----------
    isolation : {"strict", "best", "none"}
        ``strict`` demands kernel isolation.
    limits : Limits, optional
        What one submission may use.

    Raises
    ------
    IsolationError
        If ``strict`` is asked for and cannot be had.
    """
    if isolation == "strict":
        raise IsolationError(
            "isolation 'strict' cannot be had: this version runs student code in a separate process with limits, "
            "not in a sandbox. Use --isolation best, on a machine whose files may be seen."
        )
    chosen = limits or Limits()
    workshop: Workshop = _ForkingWorkshop(chosen) if hasattr(os, "fork") else _SpawningWorkshop(chosen)
    try:
        yield workshop
    finally:
        workshop.close()


class IsolationError(ValueError):
    """The demanded isolation cannot be had on this machine."""


def _clean_environment() -> dict[str, str]:
    """What a student's process may know of this machine: where programs and its Python are, nothing else."""
    kept = ("PATH", "SYSTEMROOT", "LANG", "LC_ALL", "TEMP", "TMP", "TMPDIR", "HOME", "USERPROFILE", "VIRTUAL_ENV")
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return {name: os.environ[name] for name in kept if name in os.environ} | threads | {"MPLBACKEND": "Agg"}


class _Zygote:
    """The pre-imported parent from which students' processes are forked."""

    def __init__(self, limits: Limits) -> None:
        self._control, theirs = socket.socketpair()
        self._control.settimeout(limits.start_seconds)
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", "autograder.zygote"],
                stdin=theirs.fileno(),
                stdout=subprocess.DEVNULL,
                env=_clean_environment(),
                start_new_session=True,
            )
        try:
            receive(self._control)
        except (ChannelError, TimeoutError) as error:
            self.close()
            raise IsolationError(f"the parent of the student processes did not start: {error}") from None

    def fork(self, folder: Path, channel: socket.socket, limits: Limits) -> int:
        send(self._control, {"op": "fork", "folder": str(folder), "limits": limits.as_rlimits()})
        socket.send_fds(self._control, [b"."], [channel.fileno()])
        return int(receive(self._control)["pid"])

    def end(self, pid: int) -> int:
        send(self._control, {"op": "end", "pid": pid})
        return int(receive(self._control)["status"])

    def close(self) -> None:
        with contextlib.suppress(OSError):
            self._control.shutdown(socket.SHUT_RDWR)  # wakes a thread that waits on it
        self._control.close()
        try:
            self._process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


class _ForkingWorkshop:
    """Forks every student's process from one pre-imported parent."""

    rung = "none"

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._lock = threading.Lock()
        self._closed = False
        self._zygote = _Zygote(limits)

    def start(self, folder: Path) -> Student:
        mine, theirs = socket.socketpair()
        with self._lock, theirs:
            try:
                pid = self._zygote.fork(folder, theirs, self._limits)
            except (ChannelError, OSError):  # student code can end the parent of its process, too
                if self._closed:
                    mine.close()
                    raise
                self._zygote.close()
                self._zygote = _Zygote(self._limits)
                pid = self._zygote.fork(folder, theirs, self._limits)
            zygote = self._zygote
        return Student(mine, self._limits, lambda: self._end(zygote, pid))

    def _end(self, zygote: _Zygote, pid: int) -> int:
        with self._lock:
            try:
                return zygote.end(pid)
            except (ChannelError, OSError):
                with contextlib.suppress(OSError):
                    os.killpg(pid, signal.SIGKILL)
                return -signal.SIGKILL

    def close(self) -> None:
        self._closed = True
        self._zygote.close()


class _SpawningWorkshop:
    """Starts every student's process on its own: systems that cannot fork."""

    rung = "none"

    def __init__(self, limits: Limits) -> None:
        self._limits = limits

    def start(self, folder: Path) -> Student:
        token = secrets.token_hex(16)
        with socket.create_server(("127.0.0.1", 0)) as listener:
            host, port = listener.getsockname()[:2]
            process = subprocess.Popen(
                [sys.executable, "-P", "-m", "autograder.child", f"{host}:{port}"],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd=folder,
                env=_clean_environment(),
                text=True,
            )

            def end() -> int:
                process.kill()
                return process.wait()

            assert process.stdin is not None
            process.stdin.write(token + "\n")
            process.stdin.close()
            listener.settimeout(self._limits.start_seconds)
            try:
                channel, _ = listener.accept()
                channel.settimeout(self._limits.start_seconds)
                greeting = receive(channel)
            except (TimeoutError, ChannelError) as error:
                end()
                raise StudentDied("crashed", f"the process did not start: {error}") from None
        if not secrets.compare_digest(str(greeting.get("token")).encode(), token.encode()):
            channel.close()
            end()
            raise StudentDied("crashed", "somebody else answered")
        return Student(channel, self._limits, end)

    def close(self) -> None:
        """Nothing is kept between students."""
