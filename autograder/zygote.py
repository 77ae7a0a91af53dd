"""The pre-imported parent: imports what notebooks use once, then forks one clean child a submission.

It holds no check, no answer and no submission, so a child inherits nothing worth having. It talks with the judge
over a Unix socket on its standard input: a message with a folder and limits, and the child's end of a channel as a
file descriptor.
"""

import contextlib
import os
import signal
import socket
import sys
from typing import Any

from autograder.channel import ChannelError, receive, send
from autograder.child import open_shell, serve


def main() -> None:
    """Fork children until the judge hangs up."""
    control = socket.socket(fileno=os.dup(0))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    shell = open_shell()
    children: set[int] = set()
    send(control, {"ready": True})
    while True:
        try:
            request = receive(control)
            if request["op"] == "fork":
                pid = _fork(control, request, shell)
                children.add(pid)
                send(control, {"pid": pid})
            elif request["op"] == "end":
                status = _end(request["pid"]) if request["pid"] in children else 0
                children.discard(request["pid"])
                send(control, {"status": status})
        except ChannelError:
            break
    for pid in children:
        _end(pid)


def _fork(control: socket.socket, request: dict[str, Any], shell: Any) -> int:
    _, descriptors, _, _ = socket.recv_fds(control, 1, 1)
    pid = os.fork()
    if pid:
        os.close(descriptors[0])
        return pid
    status = 1
    try:
        control.close()
        _settle_in(request)
        with socket.socket(fileno=descriptors[0]) as channel:
            serve(channel, shell)
        status = 0
    finally:
        os._exit(status)
    raise AssertionError("unreachable")


def _settle_in(request: dict[str, Any]) -> None:
    """Leave the judge's terminal and session, go to the work folder, and take on the limits."""
    import resource

    os.setsid()
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    null = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(null, descriptor)
    os.chdir(request["folder"])
    sys.path.insert(0, request["folder"])
    for name, value in request["limits"].items():
        kind = getattr(resource, name)
        most = resource.getrlimit(kind)[1]
        wanted = value if most == resource.RLIM_INFINITY else min(value, most)
        # a second above it: at the lower limit of time the process is told apart from one that was killed
        above = wanted + 1 if name == "RLIMIT_CPU" and wanted != most else wanted
        with contextlib.suppress(ValueError, OSError):  # not every system keeps every limit
            resource.setrlimit(kind, (wanted, above))


def _end(pid: int) -> int:
    """Kill a child and all that it started in its session; return how it ended."""
    for kill in (os.killpg, os.kill):
        try:
            kill(pid, signal.SIGKILL)
        except (ProcessLookupError, PermissionError):
            continue
    try:
        return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    except ChildProcessError:
        return 0


if __name__ == "__main__":
    main()
