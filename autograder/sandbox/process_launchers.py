"""Start student processes: forks of a pre-imported fork server, or new processes on systems without fork."""

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

from autograder.sandbox.bubblewrap import (
    WORK,
    Sandbox,
    SandboxError,
    copy_as_one_folder,
    find_bubblewrap,
    open_sandbox,
    sandbox_command,
)
from autograder.sandbox.channel import ChannelError, receive, send
from autograder.sandbox.confine import ProcessSettings
from autograder.sandbox.limits import Limits
from autograder.sandbox.student_process import MachineError, StudentProcess
from autograder.sandbox.workdirs import make_workdir, remove_folder

_USER_IDS = range(61184, 65520)
"""The range of systemd's dynamic users, who own no files."""


class ProcessLauncher(Protocol):
    """Starts student processes."""

    @property
    def level(self) -> str:
        """The isolation level, as written into every result."""

    @property
    def limits(self) -> Limits:
        """Limits of one submission."""

    def start(self, folder: Path) -> StudentProcess:
        """Start a process with a copy of the files in `folder` in its work folder; `MachineError` if it cannot."""

    def close(self) -> None:
        """End all student processes."""


@dataclass(frozen=True, slots=True)
class IsolationSetup:
    """An isolation level, and how it is implemented on this machine.

    Attributes
    ----------
    level : str
    own_user : bool
        Whether each process switches to its own user, which requires root.
    own_user_namespace : bool
        Whether the sandbox has a user namespace, which every user but root requires.
    """

    level: str
    own_user: bool = False
    own_user_namespace: bool = False


class ForkingLauncher:
    """Forks student processes from a fork server."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self._setup = IsolationSetup("none")
        self._sandbox_command: list[str] = []
        self._shown: Path | None = None  # the copy of labsid that sandboxes show
        self._user_ids = itertools.cycle(_USER_IDS)
        self._lock = threading.Lock()
        self._closed = False
        self._fork_server = _ForkServer(limits)

    @property
    def level(self) -> str:
        """The isolation level."""
        return self._setup.level

    @property
    def fork_server_pid(self) -> int:
        """Process ID of the fork server."""
        return self._fork_server.pid

    def configure(self, setup: IsolationSetup) -> None:
        """Choose how processes are isolated; raises `SandboxError` if bubblewrap is needed and not installed."""
        if setup.level == "namespaces":
            bubblewrap = find_bubblewrap()
            self._remove_shown()
            self._shown = make_workdir()
            allowed = copy_as_one_folder(self._fork_server.allowed, self._shown)
            self._sandbox_command = sandbox_command(
                bubblewrap, allowed, self.limits.disk_bytes, setup.own_user_namespace
            )
        self._setup = setup

    def start(self, folder: Path) -> StudentProcess:
        """Start a process with a copy of the files in `folder` in its work folder."""
        try:
            return self._start(folder)
        except OSError as error:  # no space, too many open files or processes
            raise MachineError(f"the process did not start: {error.strerror or error}") from None

    def _start(self, folder: Path) -> StudentProcess:
        setup = self._setup
        user_id = next(self._user_ids) if setup.own_user else 0
        mine, theirs = socket.socketpair()
        with theirs, contextlib.ExitStack() as undo:
            undo.callback(mine.close)
            sandbox, workdir = None, None
            if setup.level == "namespaces":
                sandbox = self._open_sandbox()
                undo.callback(sandbox.close)
            else:
                workdir = make_workdir()
                undo.callback(remove_folder, workdir)
            settings = ProcessSettings(
                level=setup.level,
                input_folder=str(folder),
                workdir=str(workdir or WORK),
                rlimits=self.limits.as_rlimits(0 if user_id else _count_tasks(os.getuid())),
                processes=self.limits.processes,
                memory_bytes=self.limits.memory_bytes,
                disk_bytes=self.limits.disk_bytes,
                sandbox_pid=sandbox.init_pid if sandbox else 0,
                own_user_namespace=setup.own_user_namespace,
                user_id=user_id,
            )
            with self._lock:
                pid = self._fork(settings, theirs)
                server = self._fork_server
            undo.pop_all()
        student = StudentProcess(mine, self.limits, lambda: self._end(server, pid, sandbox, workdir))
        try:
            student.wait_until_ready()
        except MachineError:
            student.close()
            raise
        return student

    def close(self) -> None:
        """End the fork server, which ends every process that it forked."""
        self._closed = True
        self._fork_server.close()
        self._remove_shown()

    def _remove_shown(self) -> None:
        if self._shown is not None:
            remove_folder(self._shown)

    def _open_sandbox(self) -> Sandbox:
        try:
            return open_sandbox(self._sandbox_command)
        except SandboxError as error:
            raise MachineError(f"the sandbox could not be created: {error}") from None

    def _fork(self, settings: ProcessSettings, channel: socket.socket) -> int:
        try:
            return self._fork_server.fork(settings, channel)
        except (ChannelError, OSError) as error:  # at level "none" student code can kill the fork server
            if self._closed:
                raise MachineError(f"the process did not start: {error}") from None
            self._fork_server.close()
            self._fork_server = _ForkServer(self.limits)
            try:
                return self._fork_server.fork(settings, channel)
            except (ChannelError, OSError) as again:
                raise MachineError(f"the process did not start: {again}") from None

    def _end(self, server: "_ForkServer", pid: int, sandbox: Sandbox | None, workdir: Path | None) -> tuple[int, str]:
        if sandbox:
            sandbox.close()
        try:
            with self._lock:
                return server.end(pid)
        except (ChannelError, OSError):
            with contextlib.suppress(OSError):
                os.killpg(pid, signal.SIGKILL)
            return -signal.SIGKILL, ""
        finally:
            if workdir:
                remove_folder(workdir)


class _ForkServer:
    """Connection to the fork server, which runs as a separate process."""

    def __init__(self, limits: Limits) -> None:
        self._control, theirs = socket.socketpair()
        self._control.settimeout(limits.start_seconds)
        with theirs:
            try:
                self._process = subprocess.Popen(
                    [sys.executable, "-P", "-m", "autograder.sandbox.fork_server"],
                    stdin=theirs.fileno(),
                    stdout=subprocess.DEVNULL,
                    env=_clean_environment(),
                    start_new_session=True,
                )
            except OSError as error:
                self._control.close()
                raise MachineError(f"the fork server did not start: {error.strerror or error}") from None
        try:
            reply = receive(self._control)
        except (ChannelError, TimeoutError) as error:
            self._process.kill()
            self.close()
            raise MachineError(f"the fork server did not start: {error}") from None
        if "problem" in reply:
            self.close()
            raise MachineError(
                f"the fork server did not start ({reply['problem']}). Set HOME and TMPDIR to folders that can be "
                "written and have space"
            )
        self.allowed = [Path(path) for path in reply["allowed"]]

    @property
    def pid(self) -> int:
        """Process ID."""
        return self._process.pid

    def fork(self, settings: ProcessSettings, channel: socket.socket) -> int:
        send(self._control, {"op": "fork", "settings": asdict(settings), "grader": os.getpid()})
        socket.send_fds(self._control, [b"."], [channel.fileno()])
        reply = receive(self._control)
        if "problem" in reply:
            raise MachineError(f"the process did not start: {reply['problem']}")
        return int(reply["pid"])

    def end(self, pid: int) -> tuple[int, str]:
        send(self._control, {"op": "end", "pid": pid})
        reply = receive(self._control)
        return int(reply["status"]), str(reply["exceeded"])

    def close(self) -> None:
        with contextlib.suppress(OSError):
            self._control.shutdown(socket.SHUT_RDWR)  # wakes up threads that wait on it
        self._control.close()
        try:
            self._process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


class SpawningLauncher:
    """Starts every student process as a new Python process, for systems without fork."""

    level = "none"

    def __init__(self, limits: Limits) -> None:
        self.limits = limits

    def start(self, folder: Path) -> StudentProcess:
        """Start a process with a copy of the files in `folder` in its work folder."""
        token, workdir = secrets.token_hex(16), make_workdir()
        for path in folder.iterdir():
            if path.is_file():
                shutil.copyfile(path, workdir / path.name)
        with socket.create_server(("127.0.0.1", 0)) as listener:
            host, port = listener.getsockname()[:2]
            process = subprocess.Popen(
                [sys.executable, "-P", "-m", "autograder.sandbox.child", f"{host}:{port}"],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd=workdir,
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
                remove_folder(workdir)
                return status, ""

            assert process.stdin is not None
            limits = self.limits.as_rlimits(_count_tasks(os.getuid()) if hasattr(os, "getuid") else 0)
            process.stdin.write(json.dumps({"token": token, "limits": limits}) + "\n")
            process.stdin.close()
            listener.settimeout(self.limits.start_seconds)
            try:
                channel, _ = listener.accept()
                channel.settimeout(self.limits.start_seconds)
                hello = receive(channel)
            except (TimeoutError, ChannelError) as error:
                end()
                raise MachineError(f"the process did not start: {error}") from None
        if not secrets.compare_digest(str(hello.get("token")).encode(), token.encode()):
            channel.close()
            end()
            raise MachineError("another process answered")
        return StudentProcess(channel, self.limits, end)

    def close(self) -> None:
        """Do nothing: nothing is shared between students."""


def _count_tasks(user: int) -> int:
    """Number of a user's processes and threads; 0 if unknown."""
    tasks = 0
    with contextlib.suppress(OSError):
        for entry in os.scandir("/proc"):
            if entry.name.isdigit():
                with contextlib.suppress(OSError):
                    if entry.stat().st_uid == user:
                        tasks += len(os.listdir(f"/proc/{entry.name}/task"))
    return tasks


def _clean_environment() -> dict[str, str]:
    """The environment variables of a student process: only the paths of programs and of its Python."""
    kept = ("PATH", "SYSTEMROOT", "LANG", "LC_ALL", "TEMP", "TMP", "TMPDIR", "HOME", "USERPROFILE", "VIRTUAL_ENV")
    fixed = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    fixed |= {"MALLOC_ARENA_MAX": "2"}  # more arenas would fill half the permitted address space with ten threads
    return {name: os.environ[name] for name in kept if name in os.environ} | fixed | {"MPLBACKEND": "Agg"}
