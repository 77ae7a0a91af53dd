"""Processes and what they started: counted against the limits, and ended together.

A family is a process, what descends from it, and what is in its session: those whose parent has ended keep it.
"""

import contextlib
import os
import signal
import time
from collections.abc import Iterable
from dataclasses import dataclass

_PATIENCE = 5.0
_PAGE = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 4096


@dataclass(frozen=True, slots=True)
class Family:
    """A process with all that descends from it.

    Attributes
    ----------
    members : tuple of int
        The process first.
    memory_bytes : int
        What they hold together, beside what each shares with the process that it was forked from.
    """

    members: tuple[int, ...]
    memory_bytes: int


def families_of(heads: Iterable[int], shared_bytes: int = 0) -> dict[int, Family]:
    """The family of each process, where a system shows it; what ended already has none.

    Parameters
    ----------
    heads : iterable of int
    shared_bytes : int
        Memory that every member has in common with the others, which is there once.
    """
    everybody = _everybody()
    children: dict[int, list[int]] = {}
    for process, one in everybody.items():
        children.setdefault(one.parent, []).append(process)
    found = {}
    for head in heads:
        members = [head] if head in everybody else []
        members += [process for process, one in everybody.items() if one.session == head and process != head]
        for member in members:
            members += [child for child in children.get(member, []) if child not in members]
        if members:
            held = sum(max(everybody[member].memory_bytes - shared_bytes, 0) for member in members)
            found[head] = Family(tuple(members), held)
    return found


def orphans_of(parent: int, known: Iterable[int]) -> list[int]:
    """The children of a process that are of no known family, also those that have ended and wait to be collected."""
    known = set(known)
    everybody = _everybody(ended=True).items()
    return [pid for pid, one in everybody if one.parent == parent and pid not in known and one.session not in known]


def memory_of(process: int) -> int:
    """The bytes of memory that a process holds; 0 where that is not to be seen."""
    found = _everybody().get(process)
    return 0 if found is None else found.memory_bytes


def end_families(heads: Iterable[int], wait: bool) -> None:
    """End processes with all that descends from them, also while they go on starting more.

    Parameters
    ----------
    heads : iterable of int
    wait : bool
        Whether the heads are children of the caller, for it to collect.
    """
    heads = list(heads)
    stopped: set[int] = set()
    before = time.monotonic() + _PATIENCE
    while time.monotonic() < before:
        members = {member for family in families_of(heads).values() for member in family.members} - stopped
        if not members:
            break
        for member in members:  # what stands still starts nothing
            _signal(member, signal.SIGSTOP)
        stopped |= members
    for member in stopped | set(heads if wait else ()):
        _signal(member, signal.SIGKILL)
    for head in heads if wait else ():
        with contextlib.suppress(ChildProcessError):
            os.waitpid(head, 0)


def _signal(process: int, number: int) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.kill(process, number)


@dataclass(frozen=True, slots=True)
class _Process:
    parent: int
    session: int
    memory_bytes: int


def _everybody(ended: bool = False) -> dict[int, _Process]:
    """Every process to be seen, by its number."""
    found: dict[int, _Process] = {}
    with contextlib.suppress(OSError):
        for name in os.listdir("/proc"):
            if not name.isdigit():
                continue
            with contextlib.suppress(OSError, ValueError, IndexError):
                with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as file:
                    fields = file.read().rpartition(")")[2].split()
                if ended or fields[0] != "Z":
                    found[int(name)] = _Process(int(fields[1]), int(fields[3]), int(fields[21]) * _PAGE)
    return found
