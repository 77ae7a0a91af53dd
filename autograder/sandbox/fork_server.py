"""The pre-imported parent: imports what notebooks use once, then forks one clean child a submission.

It holds no check, no answer, no reference and no submission, so a child inherits nothing worth having. It talks with
the judge over a Unix socket on its standard input: a message with the terms of a process, and the child's end of a
channel as a file descriptor. It takes in what a submission leaves running, and ends it.
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

from autograder.sandbox.allowed_paths import allowed_of_labsid
from autograder.sandbox.channel import ChannelError, receive, send
from autograder.sandbox.child import open_shell, serve
from autograder.sandbox.confine import Terms, make_call_filter, settle_in, shield
from autograder.sandbox.process_groups import end_families, families_of, memory_of, orphans_of
from autograder.sandbox.workdirs import remove, size_of

_CHANNEL = 3
_LOOK_EVERY = 0.25
_PATIENCE = 5.0


@dataclass(slots=True)
class _Child:
    """A process that was forked, what its family may use, and why it was ended, where this process did that."""

    terms: Terms
    ended_because: str = ""


def main() -> None:
    """Fork children until the judge hangs up."""
    control = socket.socket(fileno=os.dup(0))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    shell = open_shell()
    shield()
    children: dict[int, _Child] = {}
    filters: dict[tuple[int, ...], Any] = {}
    gc.collect()
    gc.freeze()  # what is here now stays shared between the children
    shared_bytes = memory_of(os.getpid())
    send(control, {"allowed": [str(path) for path in allowed_of_labsid()]})
    looked = time.monotonic()
    while True:
        if children and time.monotonic() - looked > _LOOK_EVERY:  # also while requests come one after another
            _hold_to_limits(children, shared_bytes)
            looked = time.monotonic()
        if children and not select.select([control], [], [], _LOOK_EVERY)[0]:
            continue
        try:
            request = receive(control)
            if request["op"] == "fork":
                terms = Terms(**request["terms"])
                # in a sandbox neither is to be seen, and their numbers may be those of the student's own processes
                protected = () if terms.first else (os.getpid(), request["grader"])
                if protected not in filters:
                    filters[protected] = make_call_filter(protected)
                pid = _fork(control, terms, filters[protected], shell)
                children[pid] = _Child(terms)
                send(control, {"pid": pid})
            elif request["op"] == "end":
                child = children.pop(request["pid"])
                status = _end(request["pid"], child)
                end_families(orphans_of(os.getpid(), children), wait=True)
                send(control, {"status": status, "because": child.ended_because})
        except ChannelError:
            break
    end_families([*children, *orphans_of(os.getpid(), children)], wait=True)
    for child in children.values():  # the grader was killed, and cannot
        remove(Path(child.terms.given))
        if not child.terms.first:
            remove(Path(child.terms.folder))


def _hold_to_limits(children: dict[int, _Child], shared_bytes: int) -> None:
    """End a family that has grown beyond what each of its members is held to, and orphans at once."""
    end_families(orphans_of(os.getpid(), children), wait=True)
    for pid, family in families_of(children, shared_bytes).items():
        child, terms = children[pid], children[pid].terms
        if len(family.members) > terms.processes + 2:
            child.ended_because = f"it started more than {terms.processes} processes"
        elif family.memory_bytes > terms.memory_bytes:
            child.ended_because = f"its processes took more than {terms.memory_bytes / 1024**3:g} GB together"
        elif not terms.first and size_of(Path(terms.folder)) > terms.disk_bytes:
            child.ended_because = f"its files took more than {terms.disk_bytes / 1024**2:g} MB together"
        else:
            continue
        # the first of a family in a sandbox is the messenger, and collects the others
        end_families(family.members[1:2] if terms.first else [pid], wait=False)


def _fork(control: socket.socket, terms: Terms, call_filter: Any, shell: Any) -> int:
    _, descriptors, _, _ = socket.recv_fds(control, 1, 1)
    pid = os.fork()
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
                settle_in(terms, call_filter)
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
    """Wait for a child, after ending it and all that it started; return how it ended."""
    if child.terms.first:  # it ends with its sandbox, and tells how the process in there ended
        before = time.monotonic() + _PATIENCE
        while time.monotonic() < before:
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
