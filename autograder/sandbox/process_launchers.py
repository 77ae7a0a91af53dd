"""What starts students' processes: forks of one pre-imported parent, or new processes where a system cannot fork."""

import contextlib
import itertools
import json
import os
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import threading
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol

from autograder.sandbox.bubblewrap import WORK, Sandbox, SandboxError, find_bubblewrap, layout, open_sandbox
from autograder.sandbox.channel import ChannelError, receive, send
from autograder.sandbox.confine import Terms
from autograder.sandbox.limits import Limits
from autograder.sandbox.student_process import StudentProcess, StudentProcessError
from autograder.sandbox.workdirs import make_workdir, remove

_USERS = range(61184, 65520)
"""Users that systemd hands out for a while and nobody else owns files of."""


class ProcessLauncher(Protocol):
    """Something that starts students' processes."""

    @property
    def level(self) -> str:
        """Which level of the ladder it stands on, as written into every result."""

    @property
    def limits(self) -> Limits:
        """What one submission may use."""

    def start(self, folder: Path) -> StudentProcess:
        """Start a process whose work folder holds what `folder` holds."""

    def close(self) -> None:
        """End everything that was started."""


@dataclass(frozen=True, slots=True)
class Way:
    """How a level is built.

    Attributes
    ----------
    level : str
    own_user : bool
        Whether each process becomes a user of its own, as only root can.
    own_user_namespace : bool
        Whether the sandbox has a user namespace, as everybody but root needs.
    """

    level: str
    own_user: bool = False
    own_user_namespace: bool = False


class ForkingLauncher:
    """Forks every student's process from one pre-imported parent."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self._way = Way("none")
        self._layout: list[str] = []
        self._users = itertools.cycle(_USERS)
        self._lock = threading.Lock()
        self._closed = False
        self._zygote = _Zygote(limits)

    @property
    def level(self) -> str:
        """The level that it stands on."""
        return self._way.level

    @property
    def parent(self) -> int:
        """The process from which students' processes are forked."""
        return self._zygote.pid

    def stand_on(self, way: Way) -> None:
        """Choose the level; raises `SandboxError` where what it takes is not installed."""
        if way.level == "namespaces":
            self._layout = layout(
                find_bubblewrap(), self._zygote.allowed, self.limits.disk_bytes, way.own_user_namespace
            )
        self._way = way

    def start(self, folder: Path) -> StudentProcess:
        """Start a process whose work folder holds what `folder` holds."""
        way = self._way
        user = next(self._users) if way.own_user else 0
        mine, theirs = socket.socketpair()
        with theirs, contextlib.ExitStack() as undo:
            undo.callback(mine.close)
            sandbox, place = None, None
            if way.level == "namespaces":
                sandbox = self._open_sandbox()
                undo.callback(sandbox.close)
            else:
                place = make_workdir()
                undo.callback(remove, place)
            terms = Terms(
                level=way.level,
                given=str(folder),
                folder=str(place or WORK),
                limits=self.limits.as_rlimits(0 if user else _tasks_of(os.getuid())),
                processes=self.limits.processes,
                memory_bytes=self.limits.memory_bytes,
                disk_bytes=self.limits.disk_bytes,
                first=sandbox.first if sandbox else 0,
                own_user_namespace=way.own_user_namespace,
                user=user,
            )
            with self._lock:
                pid = self._fork(terms, theirs)
                zygote = self._zygote
            undo.pop_all()
        student = StudentProcess(mine, self.limits, lambda: self._end(zygote, pid, sandbox, place))
        try:
            student.greet()
        except StudentProcessError:
            student.close()
            raise
        return student

    def close(self) -> None:
        """End the parent, and with it every process that it forked."""
        self._closed = True
        self._zygote.close()

    def _open_sandbox(self) -> Sandbox:
        try:
            return open_sandbox(self._layout)
        except SandboxError as error:
            raise StudentProcessError("crashed", f"the sandbox could not be made: {error}") from None

    def _fork(self, terms: Terms, channel: socket.socket) -> int:
        try:
            return self._zygote.fork(terms, channel)
        except (ChannelError, OSError):  # on the last level student code can end the parent of its process, too
            if self._closed:
                raise
            self._zygote.close()
            self._zygote = _Zygote(self.limits)
            return self._zygote.fork(terms, channel)

    def _end(self, zygote: "_Zygote", pid: int, sandbox: Sandbox | None, place: Path | None) -> tuple[int, str]:
        if sandbox:
            sandbox.close()
        try:
            with self._lock:
                return zygote.end(pid)
        except (ChannelError, OSError):
            with contextlib.suppress(OSError):
                os.killpg(pid, signal.SIGKILL)
            return -signal.SIGKILL, ""
        finally:
            if place:
                remove(place)


class _Zygote:
    """The pre-imported parent from which students' processes are forked."""

    def __init__(self, limits: Limits) -> None:
        self._control, theirs = socket.socketpair()
        self._control.settimeout(limits.start_seconds)
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", "autograder.sandbox.fork_server"],
                stdin=theirs.fileno(),
                stdout=subprocess.DEVNULL,
                env=_clean_environment(),
                start_new_session=True,
            )
        try:
            self.allowed = [Path(path) for path in receive(self._control)["allowed"]]
        except (ChannelError, TimeoutError) as error:
            self._process.kill()
            self.close()
            raise StudentProcessError(
                "crashed", f"the parent of the student processes did not start: {error}"
            ) from None

    @property
    def pid(self) -> int:
        """Its process."""
        return self._process.pid

    def fork(self, terms: Terms, channel: socket.socket) -> int:
        send(self._control, {"op": "fork", "terms": asdict(terms), "grader": os.getpid()})
        socket.send_fds(self._control, [b"."], [channel.fileno()])
        return int(receive(self._control)["pid"])

    def end(self, pid: int) -> tuple[int, str]:
        send(self._control, {"op": "end", "pid": pid})
        reply = receive(self._control)
        return int(reply["status"]), str(reply["because"])

    def close(self) -> None:
        with contextlib.suppress(OSError):
            self._control.shutdown(socket.SHUT_RDWR)  # wakes a thread that waits on it
        self._control.close()
        try:
            self._process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


class SpawningLauncher:
    """Starts every student's process on its own: systems that cannot fork."""

    level = "none"

    def __init__(self, limits: Limits) -> None:
        self.limits = limits

    def start(self, folder: Path) -> StudentProcess:
        """Start a process whose work folder holds what `folder` holds."""
        token, place = secrets.token_hex(16), make_workdir()
        for path in folder.iterdir():
            if path.is_file():
                shutil.copyfile(path, place / path.name)
        with socket.create_server(("127.0.0.1", 0)) as listener:
            host, port = listener.getsockname()[:2]
            process = subprocess.Popen(
                [sys.executable, "-P", "-m", "autograder.sandbox.child", f"{host}:{port}"],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd=place,
                env=_clean_environment(),
                text=True,
                start_new_session=True,
            )

            def end() -> tuple[int, str]:
                if hasattr(os, "killpg"):
                    with contextlib.suppress(OSError):
                        os.killpg(process.pid, signal.SIGKILL)
                process.kill()
                status = process.wait()
                remove(place)
                return status, ""

            assert process.stdin is not None
            limits = self.limits.as_rlimits(_tasks_of(os.getuid()) if hasattr(os, "getuid") else 0)
            process.stdin.write(json.dumps({"token": token, "limits": limits}) + "\n")
            process.stdin.close()
            listener.settimeout(self.limits.start_seconds)
            try:
                channel, _ = listener.accept()
                channel.settimeout(self.limits.start_seconds)
                greeting = receive(channel)
            except (TimeoutError, ChannelError) as error:
                end()
                raise StudentProcessError("crashed", f"the process did not start: {error}") from None
        if not secrets.compare_digest(str(greeting.get("token")).encode(), token.encode()):
            channel.close()
            end()
            raise StudentProcessError("crashed", "somebody else answered")
        return StudentProcess(channel, self.limits, end)

    def close(self) -> None:
        """Nothing is kept between students."""


def _tasks_of(user: int) -> int:
    """How many processes and threads a user has; 0 where that is not to be seen."""
    tasks = 0
    with contextlib.suppress(OSError):
        for entry in os.scandir("/proc"):
            if entry.name.isdigit():
                with contextlib.suppress(OSError):
                    if entry.stat().st_uid == user:
                        tasks += len(os.listdir(f"/proc/{entry.name}/task"))
    return tasks


def _clean_environment() -> dict[str, str]:
    """What a student's process may know of this machine: where programs and its Python are, nothing else."""
    kept = ("PATH", "SYSTEMROOT", "LANG", "LC_ALL", "TEMP", "TMP", "TMPDIR", "HOME", "USERPROFILE", "VIRTUAL_ENV")
    fixed = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    fixed |= {"MALLOC_ARENA_MAX": "2"}  # or ten threads fill half the address space that a process may have
    return {name: os.environ[name] for name in kept if name in os.environ} | fixed | {"MPLBACKEND": "Agg"}
