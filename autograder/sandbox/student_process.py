"""The judge's side of a student process: requests and their replies.

A process that ends, times out or breaks the channel raises `StudentProcessError`; the caller then starts another one.
"""

import math
import os
import signal
import socket
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from autograder.sandbox.channel import (
    MAX_OUTPUT_CHARACTERS,
    ChannelClosed,
    ChannelError,
    decode,
    encode,
    receive,
    send,
)
from autograder.sandbox.limits import Limits
from autograder.sandbox.replacing import Replacement
from labsid.checks.values import Value

_MAX_LINE = 100_000
_LONGER_AGAIN = 4

REFUSED: dict[str, Any] = {"ok": False, "error": {"kind": "RuntimeError", "text": "no such function is served here"}}
"""Reply to a call of a function that is not served."""


class MachineError(Exception):
    """This machine could not start or keep a student's process: no fault of the student, and no grade."""


class StudentProcessError(Exception):
    """The student's process ended, timed out or sent an invalid reply; `status` is the question's status."""

    def __init__(self, status: str, text: str) -> None:
        super().__init__(text)
        self.status = status

    def __reduce__(self) -> tuple[type["StudentProcessError"], tuple[str, str]]:
        return StudentProcessError, (self.status, str(self))


@dataclass(frozen=True, slots=True)
class Reply:
    """The reply to a request: a value, or the error."""

    ok: bool
    value: Value = None
    error: Mapping[str, Any] | None = None
    stdout: str = ""


class StudentProcess:
    """A running student process.

    Attributes
    ----------
    channel : socket.socket
        Its end of the channel.
    lost : bool
        Whether it ended, timed out or broke the channel.
    deadline : float
        The end of the submission's time, on the monotonic clock.
    server : callable or None
        ``server(asks) -> reply`` to what the process asks for while it works on a request: the call of a function that
        the judge serves. Without one, every call is refused.
    """

    def __init__(self, channel: socket.socket, limits: Limits, end: Callable[[], tuple[int, str]]) -> None:
        self.channel = channel
        self._limits = limits
        self._end = end
        self._ended: tuple[int, str] | None = None
        self.lost = False
        self.deadline = math.inf
        self.server: Callable[[Mapping[str, Any]], dict[str, Any]] | None = None

    def wait_until_ready(self) -> None:
        """Wait until the process is confined and ready to run cells; raises `MachineError` if it does not start."""
        try:
            reply = self._ask(None, self._limits.start_seconds)
        except StudentProcessError as error:
            raise MachineError(f"the process did not start: {error}") from None
        if not reply.ok:
            raise MachineError(f"the process did not start: {(reply.error or {}).get('text', '')}")

    def run(self, source: str, replacements: Iterable[Replacement] = (), again: bool = False) -> Reply:
        """Run one cell, and replace wrong values where its statements make them.

        A cell that has run within its time may take longer when it runs `again`: values are replaced in it, and the
        machine may be busier.
        """
        encoded = [_encode_replacement(one) for one in replacements]
        request = {"op": "run", "source": source, **({"replacements": encoded} if encoded else {})}
        return self._ask(request, self._limits.cell_seconds * (_LONGER_AGAIN if again else 1))

    def value(self, name: str) -> Reply:
        """Read a variable."""
        return self._ask({"op": "value", "name": name}, self._limits.call_seconds)

    def call(self, name: str, *arguments: Value) -> Reply:
        """Call one of the student's functions."""
        encoded = [encode(argument) for argument in arguments]
        return self._ask({"op": "call", "name": name, "arguments": encoded}, self._limits.call_seconds)

    def changes(self, name: str, *arguments: Value) -> Reply:
        """Call one of the student's functions, and say whether it has changed an array that it was given."""
        encoded = [encode(argument) for argument in arguments]
        return self._ask({"op": "changes", "name": name, "arguments": encoded}, self._limits.call_seconds)

    def call_encoded(self, name: str, arguments: list[Any], keywords: Mapping[str, Any]) -> Reply:
        """Call a function with arguments that another process has sent, some of which may be its functions."""
        request = {"op": "call", "name": name, "arguments": arguments, "keywords": dict(keywords)}
        return self._ask(request, self._limits.call_seconds)

    def call_back(self, key: int, arguments: list[Any]) -> Reply:
        """Call a function that this process has passed to one that the judge serves, while it waits for that."""
        return self._ask({"op": "call back", "key": key, "arguments": arguments}, self._limits.call_seconds)

    def replace(self, replacement: Replacement) -> Reply:
        """Set right values, and functions that the judge serves, to carry them forward."""
        return self._ask({"op": "set", "replacement": _encode_replacement(replacement)}, self._limits.call_seconds)

    def save_variables(self, key: int) -> Reply:
        """Save the current variables under a key."""
        return self._ask({"op": "save", "key": key}, self._limits.call_seconds)

    def restore_variables(self, key: int) -> bool:
        """Restore the variables saved under a key; returns whether any of them was modified in place.

        Raises
        ------
        StudentProcessError
            Also if they have not been saved; the process then is as it was.
        """
        reply = self._ask({"op": "restore", "key": key}, self._limits.call_seconds)
        if not reply.ok:
            raise StudentProcessError("crashed", "the variables at this step could not be restored")
        return reply.value is not False

    def _wait_until(self, end: float) -> None:
        left = end - time.monotonic()
        if left <= 0:
            raise TimeoutError
        self.channel.settimeout(left)

    def close(self) -> tuple[int, str]:
        """End the process and everything it started; returns its exit status and the limit it exceeded, if any."""
        if self._ended is None:
            self.channel.close()
            self._ended = self._end()
        return self._ended

    def _ask(self, request: dict[str, Any] | None, seconds: float) -> Reply:
        seconds_left = self.deadline - time.monotonic()
        end = time.monotonic() + min(seconds, seconds_left)
        try:
            self._wait_until(end)
            if request is not None:
                send(self.channel, request)
            while True:
                message = receive(self.channel)
                if "asks" not in message:
                    return _read_reply(message)
                reply = REFUSED if self.server is None else self.server(message)
                self._wait_until(end)
                send(self.channel, reply)
        except TimeoutError:
            self.lost = True
            most = f"the whole notebook took longer than {self._limits.submission_seconds:g} s"
            raise StudentProcessError(
                "timeout", most if seconds_left < seconds else f"it took longer than {seconds:g} s"
            ) from None
        except (ChannelClosed, OSError):
            self.lost = True
            status, exceeded = self.close()
        except ChannelError as error:
            self.lost = True
            raise StudentProcessError("crashed", str(error)) from None
        if exceeded:
            raise StudentProcessError("limit", exceeded)
        if os.name == "posix" and status == -signal.SIGXCPU:
            raise StudentProcessError("limit", f"it used more than {self._limits.cpu_seconds} s of processor time")
        how = f"was ended by {_signal_name(-status)}" if status < 0 else f"ended with exit status {status}"
        raise StudentProcessError("crashed", f"its process {how}")


def _encode_replacement(one: Replacement) -> dict[str, Any]:
    return {
        "right": {name: encode(value) for name, value in one.right.items()},
        "wrong": {name: encode(value) for name, value in one.wrong.items()},
        "functions": list(one.functions),
        "kept": sorted(one.kept),
    }


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:  # student code chooses the number where it can end its own parent
        return f"signal {number}"


def _read_reply(message: dict[str, Any]) -> Reply:
    """Validate the types and sizes of a reply's parts."""
    error = message.get("error")
    return Reply(
        ok=message.get("ok") is True,
        value=decode(message["value"]) if "value" in message else None,
        error=_read_error(error) if isinstance(error, dict) else None,
        stdout=str(message.get("stdout", ""))[:MAX_OUTPUT_CHARACTERS],
    )


def _read_error(error: dict[str, Any]) -> dict[str, Any]:
    read: dict[str, Any] = {key: str(error[key])[:500] for key in ("kind", "text") if error.get(key) is not None}
    line = error.get("line")
    return {**read, "line": line} if type(line) is int and 0 < line < _MAX_LINE else read
