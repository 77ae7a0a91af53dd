"""What a check can ask, backed by a student's process."""

from collections.abc import Callable, Mapping

import numpy as np

from autograder.isolation import Student
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer
from labsid.record import Record


class ProcessAsk:
    """Asks a student's process."""

    def __init__(
        self,
        student: Callable[[], Student],
        record: Record | None,
        known: Mapping[str, Value],
        rng: np.random.Generator,
    ) -> None:
        self._student = student
        self._record = record
        self._known = known
        self.rng = rng

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
        reply = self._student().call(name, *arguments)
        if reply.error is not None:
            raise NoAnswer(f"`{name}` stopped with {said(reply.error)}.")
        if not reply.ok:
            raise NoAnswer(f"There is no function `{name}`: it is not defined.")
        return reply.value

    def known(self, name: str) -> Value:
        """A value of an earlier step, right or made right."""
        return self._known[name]


def said(error: Mapping[str, str]) -> str:
    """Kind and text of an error, without the full stop."""
    return f"{error.get('kind')}: {error.get('text', '')}".rstrip(".: ")
