"""One student's process, as the judge sees it: what can be asked of it, and how it may end.

Dying, taking too long and breaking the channel are all `StudentProcessError`; the caller starts another one.
"""

import math
import os
import signal
import socket
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from autograder.sandbox.channel import (
    MAX_OUTPUT_CHARACTERS,
    ChannelError,
    Gone,
    decode,
    encode,
    receive,
    send,
)
from autograder.sandbox.limits import Limits
from labsid.checks.values import Value

_MOST_LINES = 100_000


class StudentProcessError(Exception):
    """The student's process ended, hung, or sent what is no answer; `status` is that of GRADING.md."""

    def __init__(self, status: str, text: str) -> None:
        super().__init__(text)
        self.status = status

    def __reduce__(self) -> tuple[type["StudentProcessError"], tuple[str, str]]:
        return StudentProcessError, (self.status, str(self))


@dataclass(frozen=True, slots=True)
class Reply:
    """What came back: a value, or why there is none."""

    ok: bool
    value: Value = None
    error: Mapping[str, Any] | None = None
    stdout: str = ""


class StudentProcess:
    """One student's process, spoken to over its channel."""

    def __init__(self, channel: socket.socket, limits: Limits, end: Callable[[], tuple[int, str]]) -> None:
        self._channel = channel
        self._limits = limits
        self._end = end
        self._ended: tuple[int, str] | None = None
        self.lost = False
        """Whether it ended, hung or broke the channel."""
        self.until = math.inf
        """When everything must be done, by the monotonic clock."""

    def greet(self) -> None:
        """Wait until the process has settled in; `StudentProcessError` says why it has not."""
        reply = self._ask(None, self._limits.start_seconds)
        if not reply.ok:
            raise StudentProcessError("crashed", f"the process did not start: {(reply.error or {}).get('text', '')}")

    def run(self, source: str) -> Reply:
        """Run one cell."""
        return self._ask({"op": "run", "source": source}, self._limits.cell_seconds)

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

    def pin(self, key: int) -> Reply:
        """Keep the variables as they are now, to be put back under that key."""
        return self._ask({"op": "pin", "key": key}, self._limits.call_seconds)

    def put_back(self, key: int) -> bool:
        """Put back the variables kept under a key; whether something in them was changed in place since."""
        return self._ask({"op": "put back", "key": key}, self._limits.call_seconds).value is not False

    def close(self) -> tuple[int, str]:
        """End the process and everything it started, once; return how it ended, and the limit that ended it."""
        if self._ended is None:
            self._channel.close()
            self._ended = self._end()
        return self._ended

    def _ask(self, request: dict[str, Any] | None, seconds: float) -> Reply:
        left = self.until - time.monotonic()
        try:
            if left <= 0:
                raise TimeoutError
            self._channel.settimeout(min(seconds, left))
            if request is not None:
                send(self._channel, request)
            return _read_reply(receive(self._channel))
        except TimeoutError:
            self.lost = True
            most = f"all of the notebook together took longer than {self._limits.submission_seconds:g} s"
            raise StudentProcessError(
                "timeout", most if left < seconds else f"it took longer than {seconds:g} s"
            ) from None
        except (Gone, OSError):
            self.lost = True
            status, because = self.close()
        except ChannelError as error:
            self.lost = True
            raise StudentProcessError("crashed", str(error)) from None
        if because:
            raise StudentProcessError("limit", because)
        if os.name == "posix" and status == -signal.SIGXCPU:
            raise StudentProcessError("limit", f"it used more than {self._limits.cpu_seconds} s of processor time")
        how = f"was ended by {_name_of(-status)}" if status < 0 else f"ended with exit status {status}"
        raise StudentProcessError("crashed", f"its process {how}")


def _name_of(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:  # student code tells it where it is the student's own process that was forked
        return f"signal {number}"


def _read_reply(message: dict[str, Any]) -> Reply:
    """A reply whose every part is of the kind, and of a size, that its reader relies on."""
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
    return {**read, "line": line} if type(line) is int and 0 < line < _MOST_LINES else read
