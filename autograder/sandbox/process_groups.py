"""Find, measure and kill a process together with everything it started.

A process group here is a leader, its descendants, and the members of its session: a process whose parent has ended
keeps its session.
"""

import contextlib
import os
import signal
import time
from collections.abc import Iterable
from dataclasses import dataclass

_KILL_SECONDS = 5.0
_PAGE_BYTES = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 4096


@dataclass(frozen=True, slots=True)
class ProcessGroup:
    """A process and everything it started.

    Attributes
    ----------
    members : tuple of int
        Process IDs, the leader first.
    memory_bytes : int
        Total memory, without the pages that each member shares with the process it was forked from.
    """

    members: tuple[int, ...]
    memory_bytes: int


def find_process_groups(leaders: Iterable[int], shared_bytes: int = 0) -> dict[int, ProcessGroup]:
    """Find the process group of each leader that is running; empty on systems without ``/proc``.

    Parameters
    ----------
    leaders : iterable of int
    shared_bytes : int
        Memory that all members share, subtracted from each.
    """
    processes = _list_processes()
    children: dict[int, list[int]] = {}
    for pid, process in processes.items():
        children.setdefault(process.parent, []).append(pid)
    groups = {}
    for leader in leaders:
        members = [leader] if leader in processes else []
        members += [pid for pid, process in processes.items() if process.session == leader and pid != leader]
        for member in members:
            members += [child for child in children.get(member, []) if child not in members]
        if members:
            memory = sum(max(processes[member].memory_bytes - shared_bytes, 0) for member in members)
            groups[leader] = ProcessGroup(tuple(members), memory)
    return groups


def find_orphans(parent: int, leaders: Iterable[int]) -> list[int]:
    """The children of a process that belong to no known leader, including ended ones that nobody waited for."""
    known = set(leaders)
    processes = _list_processes(ended=True).items()
    return [pid for pid, one in processes if one.parent == parent and pid not in known and one.session not in known]


def resident_bytes(pid: int) -> int:
    """Resident memory of a process; 0 if unknown."""
    process = _list_processes().get(pid)
    return 0 if process is None else process.memory_bytes


def kill_process_groups(leaders: Iterable[int], wait: bool) -> None:
    """Kill process groups, even while their members keep starting processes.

    Parameters
    ----------
    leaders : iterable of int
    wait : bool
        Whether to wait for the leaders, which are then children of the caller.
    """
    leaders = list(leaders)
    if not leaders:  # and no list of all processes is needed, which takes longer than a fork
        return
    stopped: set[int] = set()
    deadline = time.monotonic() + _KILL_SECONDS
    while time.monotonic() < deadline:
        members = {member for group in find_process_groups(leaders).values() for member in group.members} - stopped
        if not members:
            break
        for member in members:  # a stopped process cannot start others
            _signal(member, signal.SIGSTOP)
        stopped |= members
    for member in stopped | set(leaders if wait else ()):
        _signal(member, signal.SIGKILL)
    for leader in leaders if wait else ():
        with contextlib.suppress(ChildProcessError):
            os.waitpid(leader, 0)


def _signal(pid: int, number: int) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.kill(pid, number)


@dataclass(frozen=True, slots=True)
class _Process:
    parent: int
    session: int
    memory_bytes: int


def _list_processes(ended: bool = False) -> dict[int, _Process]:
    """Every visible process by its ID."""
    processes: dict[int, _Process] = {}
    with contextlib.suppress(OSError):
        for name in os.listdir("/proc"):
            if not name.isdigit():
                continue
            with contextlib.suppress(OSError, ValueError, IndexError):
                with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as file:
                    fields = file.read().rpartition(")")[2].split()
                if ended or fields[0] != "Z":
                    processes[int(name)] = _Process(int(fields[1]), int(fields[3]), int(fields[21]) * _PAGE_BYTES)
    return processes
