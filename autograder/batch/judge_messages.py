"""The messages between the grader and the judge's process: pickled, as both sides trust each other."""

import pickle
import socket
import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from autograder.sandbox.limits import Limits

_HEADER = struct.Struct(">Q")


@dataclass(frozen=True, slots=True)
class Call:
    """A call that the grader asks for.

    Attributes
    ----------
    function : callable
    arguments : tuple
    level : str or None
        Isolation level of the launcher that is passed as the last argument; None without one.
    limits : Limits
        Limits of the student's processes.
    cpu_seconds : float
        Processor time of the call.
    """

    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    level: str | None
    limits: Limits
    cpu_seconds: float


@dataclass(frozen=True, slots=True)
class Start:
    """Request of the judge: start a student's process, and pass on its channel."""

    folder: Path


@dataclass(frozen=True, slots=True)
class End:
    """Request of the judge: end a student's process, and tell how it ended."""

    key: int


@dataclass(frozen=True, slots=True)
class Problem:
    """The machine could not do what was asked."""

    text: str


@dataclass(frozen=True, slots=True)
class Failed:
    """A call that failed: the reason for the student, and the details for the instructor."""

    reason: str
    details: str = ""


@dataclass(frozen=True, slots=True)
class Returned:
    """The value of a call."""

    value: Any


def send_message(sock: socket.socket, message: object) -> None:
    """Send a message."""
    send_bytes(sock, pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL))


def send_bytes(sock: socket.socket, payload: bytes) -> None:
    """Send a pickled message."""
    sock.sendall(_HEADER.pack(len(payload)))
    sock.sendall(payload)


def receive_message(sock: socket.socket) -> Any:
    """Receive a message; raises `EOFError` if the other side has closed the connection."""
    (length,) = _HEADER.unpack(_read(sock, _HEADER.size))
    return pickle.loads(_read(sock, length))


def _read(sock: socket.socket, size: int) -> bytes:
    data = bytearray()
    while len(data) < size:
        chunk = sock.recv(min(size - len(data), 1 << 20))
        if not chunk:
            raise EOFError("the connection is closed")
        data += chunk
    return bytes(data)
