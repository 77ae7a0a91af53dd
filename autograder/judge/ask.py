"""What a check can ask, backed by a student's process."""

from collections.abc import Callable, Iterable, Mapping

import numpy as np

from autograder.judge.redaction import redact, redact_error
from autograder.sandbox.isolation import StudentProcess
from labsid.checks.question import Origin
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer
from labsid.plots.figure_values import FigureValue
from labsid.records.record import Record


class CallDeferred(BaseException):
    """A check wants a function called, and this is not the time: not an `Exception`, which a check may catch."""


class ProcessAsk:
    """Asks a student's process, and keeps the values that it was handed: for pictures, and to see whose data they are.

    `calls` is the process in which functions are called, the same where it is None. A function sees the judge's hidden
    inputs. So where `later` is set, wanting one called is `AsksForCalls`. What is handed on is no more than may be told
    to the author of `source`, the notebook.
    """

    def __init__(
        self,
        student: Callable[[], StudentProcess],
        record: Record | None,
        known: Mapping[str, Value],
        rng: np.random.Generator,
        origin: Origin | None = None,
        source: str = "",
    ) -> None:
        self._student = student
        self._record = record
        self._known = known
        self._source = source
        self._seen: dict[str, Value] = {}
        self.rng = rng
        self.origin = origin
        self.later = False
        self.calls: StudentProcess | None = None

    @property
    def record(self) -> Record:
        """The record that this student works on."""
        if self._record is None:
            raise ValueError("this assignment has no record")
        return self._record

    def value(self, name: str) -> Value:
        """The variable as plain data; asked for once, as an object of the student's may answer otherwise next time."""
        if name not in self._seen:
            reply = self._student().value(name)
            if reply.error is not None:
                raise NoAnswer(f"`{name}` cannot be read ({error_text(redact_error(reply.error, self._source))}).")
            if not reply.ok:
                raise NoAnswer(f"There is no variable `{name}`: it is not defined.")
            self._seen[name] = redact(reply.value, self._source)
        return self._seen[name]

    def call(self, name: str, *arguments: Value) -> Value:
        """What the function of that name returns, as plain data."""
        if self.later:
            raise CallDeferred
        reply = (self.calls or self._student()).call(name, *arguments)
        if reply.error is not None:
            raise NoAnswer(f"`{name}` stopped with {error_text(redact_error(reply.error, self._source))}.")
        if not reply.ok:
            raise NoAnswer(f"There is no function `{name}`: it is not defined.")
        return redact(reply.value, self._source)

    def known(self, name: str) -> Value:
        """A value of an earlier step, right or made right."""
        return self._known[name]

    @property
    def figures(self) -> tuple[FigureValue, ...]:
        """The figures that were asked for."""
        return tuple(value for value in self._seen.values() if isinstance(value, FigureValue))

    def values_of(self, names: Iterable[str]) -> dict[str, Value]:
        """Those of the variables that were asked for."""
        return {name: self._seen[name] for name in names if name in self._seen}


def error_text(error: Mapping[str, str]) -> str:
    """Kind and text of an error, without the full stop."""
    return f"{error.get('kind')}: {error.get('text', '')}".rstrip(".: ")
