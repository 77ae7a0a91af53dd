"""What a check can ask, backed by a student's process."""

import re
from collections.abc import Callable, Mapping

import numpy as np

from autograder.isolation import Student
from labsid.checks.question import Origin
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer
from labsid.record import Record

_NUMBER = re.compile(r"[-+]?(\d+\.\d*|\.\d+|\d{5,}|\d+(?=[eE][-+]?\d))([eE][-+]?\d+)?")
_QUOTED = re.compile(r"'[^']{40,}'|\"[^\"]{40,}\"")
_MOST_TEXT = 200


class AsksForCalls(BaseException):
    """A check wants a function called, and this is not the time: not an `Exception`, which a check may catch."""


class ProcessAsk:
    """Asks a student's process; `calls` is the process in which functions are called, the same where it is None.

    A function sees the judge's hidden inputs. So where `later` is set, wanting one called is `AsksForCalls`.
    """

    def __init__(
        self,
        student: Callable[[], Student],
        record: Record | None,
        known: Mapping[str, Value],
        rng: np.random.Generator,
        origin: Origin | None = None,
    ) -> None:
        self._student = student
        self._record = record
        self._known = known
        self.rng = rng
        self.origin = origin
        self.later = False
        self.calls: Student | None = None

    @property
    def record(self) -> Record:
        """The record that this student works on."""
        if self._record is None:
            raise ValueError("this assignment has no record")
        return self._record

    def value(self, name: str) -> Value:
        """The variable as plain data."""
        reply = self._student().value(name)
        if reply.error is not None:
            raise NoAnswer(f"`{name}` cannot be read ({said(reply.error)}).")
        if not reply.ok:
            raise NoAnswer(f"There is no variable `{name}`: it is not defined.")
        return reply.value

    def call(self, name: str, *arguments: Value) -> Value:
        """What the function of that name returns, as plain data."""
        if self.later:
            raise AsksForCalls
        reply = (self.calls or self._student()).call(name, *arguments)
        if reply.error is not None:
            raise NoAnswer(f"`{name}` stopped with {said(without_inputs(reply.error))}.")
        if not reply.ok:
            raise NoAnswer(f"There is no function `{name}`: it is not defined.")
        return reply.value

    def known(self, name: str) -> Value:
        """A value of an earlier step, right or made right."""
        return self._known[name]


def without_inputs(error: Mapping[str, str]) -> dict[str, str]:
    """An error of a function that was called on hidden inputs, without the numbers that it may tell of them."""
    text = _QUOTED.sub("'…'", _NUMBER.sub("…", error.get("text", "")))
    return {**error, "text": text[:_MOST_TEXT]}


def said(error: Mapping[str, str]) -> str:
    """Kind and text of an error, without the full stop."""
    return f"{error.get('kind')}: {error.get('text', '')}".rstrip(".: ")
