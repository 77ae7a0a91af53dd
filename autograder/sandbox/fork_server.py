"""The fork server: imports the packages that notebooks use once, then forks one child for each submission.

It holds no check, no right value, no reference and no submission, so a child inherits nothing to protect. The judge
sends requests over a Unix socket on standard input: the settings of a process, and the child's end of its channel as a
file descriptor. The fork server adopts and kills the processes that a submission leaves running.
"""

import contextlib
import gc
import os
import select
import signal
import socket
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from autograder.sandbox.allowed_paths import allowed_labsid_paths
from autograder.sandbox.channel import ChannelError, receive, send
from autograder.sandbox.child import block_reference, open_shell, serve
from autograder.sandbox.confine import ProcessSettings, confine_process, make_syscall_filter, prepare_fork_server
from autograder.sandbox.process_groups import (
    find_orphans,
    find_process_groups,
    kill_process_groups,
    resident_bytes,
)
from autograder.sandbox.workdirs import folder_bytes, remove_folder

_CHANNEL = 3
_POLL_SECONDS = 0.25
_END_SECONDS = 5.0


@dataclass(slots=True)
class _Child:
    """A forked process: its settings, and the limit its group exceeded, if the fork server killed it."""

    settings: ProcessSettings
    exceeded: str = ""


def main() -> None:
    """Fork children until the judge closes the connection."""
    control = socket.socket(fileno=os.dup(0))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        shell = open_shell()
    except OSError as error:  # no folder for settings and caches, or no space in it
        place = error.filename if error.filename2 is None else error.filename2
        send(control, {"problem": str(error) if place is None else f"{place}: {error.strerror}"})
        return
    block_reference()  # once for all children
    prepare_fork_server()
    children: dict[int, _Child] = {}
    filters: dict[tuple[int, ...], Any] = {}
    gc.collect()
    gc.freeze()  # the children keep sharing these objects' memory
    shared_bytes = resident_bytes(os.getpid())
    send(control, {"allowed": [str(path) for path in allowed_labsid_paths()]})
    polled = time.monotonic()
    while True:
        if children and time.monotonic() - polled > _POLL_SECONDS:  # also under a steady stream of requests
            _enforce_limits(children, shared_bytes)
            polled = time.monotonic()
        if children and not select.select([control], [], [], _POLL_SECONDS)[0]:
            continue
        try:
            request = receive(control)
            if request["op"] == "fork":
                settings = ProcessSettings(**request["settings"])
                # in a sandbox neither is visible, and their numbers may be those of the student's own processes
                protected = () if settings.sandbox_pid else (os.getpid(), request["grader"])
                if protected not in filters:
                    filters[protected] = make_syscall_filter(protected)
                try:
                    pid = _fork(control, settings, filters[protected], shell)
                except OSError as error:  # the limit of processes, or no memory
                    send(control, {"problem": str(error.strerror)})
                    continue
                children[pid] = _Child(settings)
                send(control, {"pid": pid})
            elif request["op"] == "end":
                child = children.pop(request["pid"])
                status = _end(request["pid"], child)
                kill_process_groups(find_orphans(os.getpid(), children), wait=True)
                send(control, {"status": status, "exceeded": child.exceeded})
        except ChannelError:
            break
    kill_process_groups([*children, *find_orphans(os.getpid(), children)], wait=True)
    for child in children.values():  # the grader was killed and cannot remove them
        remove_folder(Path(child.settings.input_folder))
        if not child.settings.sandbox_pid:
            remove_folder(Path(child.settings.workdir))


def _enforce_limits(children: dict[int, _Child], shared_bytes: int) -> None:
    """Kill orphans, and process groups that exceed the limits of a group; rlimits bound only single processes."""
    kill_process_groups(find_orphans(os.getpid(), children), wait=True)
    for pid, group in find_process_groups(children, shared_bytes).items():
        child, settings = children[pid], children[pid].settings
        if len(group.members) > settings.processes + 2:
            child.exceeded = f"it started more than {settings.processes} processes"
        elif group.memory_bytes > settings.memory_bytes:
            child.exceeded = f"its processes took more than {settings.memory_bytes / 1024**3:g} GB together"
        elif not settings.sandbox_pid and folder_bytes(Path(settings.workdir)) > settings.disk_bytes:
            child.exceeded = f"its files took more than {settings.disk_bytes / 1024**2:g} MB together"
        else:
            continue
        # with a sandbox, the leader waits for the student process outside and must report its status
        kill_process_groups(group.members[1:2] if settings.sandbox_pid else [pid], wait=False)


def _fork(control: socket.socket, settings: ProcessSettings, syscall_filter: Any, shell: Any) -> int:
    _, descriptors, _, _ = socket.recv_fds(control, 1, 1)
    try:
        pid = os.fork()
    except OSError:
        os.close(descriptors[0])
        raise
    if pid:
        os.close(descriptors[0])
        return pid
    status = 1
    try:
        control.close()
        if descriptors[0] != _CHANNEL:
            os.dup2(descriptors[0], _CHANNEL, inheritable=False)
        with socket.socket(fileno=_CHANNEL) as channel:
            try:
                confine_process(settings, syscall_filter)
            except Exception as error:
                send(channel, {"ok": False, "error": {"kind": type(error).__name__, "text": str(error)}})
                raise
            send(channel, {"ok": True})
            serve(channel, shell)
        status = 0
    finally:
        os._exit(status)
    raise AssertionError("unreachable")


def _end(pid: int, child: _Child) -> int:
    """Kill a child and everything it started; return its exit status."""
    if child.settings.sandbox_pid:  # it ends with its sandbox, and exits with the status of the process inside
        deadline = time.monotonic() + _END_SECONDS
        while time.monotonic() < deadline:
            ended, status = os.waitpid(pid, os.WNOHANG)
            if ended:
                return os.waitstatus_to_exitcode(status)
            time.sleep(0.001)
    for send_signal in (os.killpg, os.kill):
        with contextlib.suppress(ProcessLookupError, PermissionError):
            send_signal(pid, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])


if __name__ == "__main__":
    main()
