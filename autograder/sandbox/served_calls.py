"""Calls between processes through the judge: functions that the judge serves, and functions passed to them.

A function of the model solution runs in a process without student code. In the student's process there is a function
that sends plain arguments and receives a plain value. A function of the student's among the arguments is called back in
the student's process in the same way.
"""

import itertools
import socket
import threading
from collections.abc import Callable, Mapping
from typing import Any

from autograder.sandbox.channel import decode, encode, receive, send
from autograder.sandbox.replacing import as_object
from labsid.checks.values import Unreadable, Value, plain

FUNCTION = "function"
"""Tag of a function among the arguments: ``{"!": "function", "key": 3}``."""

_TAG = "!"


class ServedCalls:
    """One process's end of the calls.

    Parameters
    ----------
    channel : socket.socket
        To the judge.
    answer : callable
        ``answer(request) -> reply`` to a request that comes while this process waits.
    """

    def __init__(self, channel: socket.socket, answer: Callable[[dict[str, Any]], dict[str, Any]]) -> None:
        self._channel = channel
        self._answer = answer
        self._lock = threading.RLock()
        self._keys = itertools.count()
        self._passed: dict[int, Callable[..., Any]] = {}

    def function(self, name: str) -> Callable[..., Any]:
        """A function that the judge serves under a name."""

        def served(*arguments: Any, **keywords: Any) -> Any:
            return self._ask({"name": name}, arguments, keywords)

        served.__name__ = served.__qualname__ = name
        return served

    def called_back(self, key: int, arguments: list[Any]) -> Any:
        """Call a function that this process has passed as an argument."""
        return self._passed[key](*map(self.argument, arguments))

    def argument(self, encoded: Any) -> Any:
        """An argument of a call: a plain value, or a function of the other process."""
        if isinstance(encoded, dict) and encoded.get(_TAG) == FUNCTION:
            key = int(encoded["key"])
            return lambda *arguments: self._ask({"key": key}, arguments, {})
        decoded = as_object(decode(encoded))
        return list(decoded) if isinstance(decoded, tuple) else decoded  # a list, as in the notebook

    def _ask(self, wanted: dict[str, Any], arguments: tuple[Any, ...], keywords: dict[str, Any]) -> Any:
        with self._lock:
            passed: list[int] = []
            asks = {
                **wanted,
                "arguments": [self._encode(value, passed) for value in arguments],
                "keywords": {name: self._encode(value, passed) for name, value in keywords.items()},
            }
            try:
                send(self._channel, {"asks": asks})
                while "op" in (reply := receive(self._channel)):
                    send(self._channel, self._answer(reply))
            finally:
                for key in passed:
                    del self._passed[key]
        if reply.get("ok") is True:
            return as_object(decode(reply["value"]))
        error = reply.get("error") or {}
        raise RuntimeError(str(error.get("text") or "the call failed"))

    def _encode(self, value: Any, passed: list[int]) -> Any:
        found = plain(value)
        if isinstance(found, Unreadable) and callable(value):
            key = next(self._keys)
            self._passed[key] = value
            passed.append(key)
            return {_TAG: FUNCTION, "key": key}
        return encode(found)


def checked_argument(encoded: Any) -> Any:
    """An argument as it goes on to the other process; raises `ChannelError` if it is not one."""
    if isinstance(encoded, dict) and encoded.get(_TAG) == FUNCTION and type(encoded.get("key")) is int:
        return {_TAG: FUNCTION, "key": encoded["key"]}
    return encode(decode(encoded))


def is_plain(value: Value) -> bool:
    """Whether a value has no part that cannot be read."""
    if isinstance(value, Mapping):
        return all(map(is_plain, value.values()))
    return all(map(is_plain, value)) if isinstance(value, (tuple, list)) else not isinstance(value, Unreadable)
