"""The interface between checks and a student's process."""

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
    """A check calls a function while calls are deferred; not an `Exception`, which a check may catch."""


class ProcessAsk:
    """Answers a check from a student's process, redacted for the author of `source`, the notebook.

    The values read are kept, for the figures of the feedback and to detect answers made on another student's record.

    Attributes
    ----------
    defer_calls : bool
        Whether to raise `CallDeferred` instead of calling a function, which would receive hidden inputs.
    call_process : StudentProcess or None
        The process in which functions are called; None for the process of the variables.
    """

    def __init__(
        self,
        process: Callable[[], StudentProcess],
        record: Record | None,
        known: Mapping[str, Value],
        rng: np.random.Generator,
        origin: Origin | None = None,
        source: str = "",
    ) -> None:
        self._process = process
        self._record = record
        self._known = known
        self._source = source
        self._values: dict[str, Value] = {}
        self.rng = rng
        self.origin = origin
        self.defer_calls = False
        self.call_process: StudentProcess | None = None

    @property
    def record(self) -> Record:
        """The student's record."""
        if self._record is None:
            raise ValueError("this assignment has no record")
        return self._record

    def value(self, name: str) -> Value:
        """The variable as plain data; read only once, because a student's object can change its answer."""
        if name not in self._values:
            reply = self._process().value(name)
            if reply.error is not None:
                raise NoAnswer(f"`{name}` cannot be read ({error_text(redact_error(reply.error, self._source))}).")
            if not reply.ok:
                raise NoAnswer(f"There is no variable `{name}`: it is not defined.")
            self._values[name] = redact(reply.value, self._source)
        return self._values[name]

    def call(self, name: str, *arguments: Value) -> Value:
        """The return value of the function, as plain data."""
        if self.defer_calls:
            raise CallDeferred
        reply = (self.call_process or self._process()).call(name, *arguments)
        if reply.error is not None:
            raise NoAnswer(f"`{name}` stopped with {error_text(redact_error(reply.error, self._source))}.")
        if not reply.ok:
            raise NoAnswer(f"There is no function `{name}`: it is not defined.")
        return redact(reply.value, self._source)

    def known(self, name: str) -> Value:
        """A value of an earlier step: the student's if it was right, otherwise the reference's."""
        return self._known[name]

    @property
    def figures(self) -> tuple[FigureValue, ...]:
        """The figures read so far."""
        return tuple(value for value in self._values.values() if isinstance(value, FigureValue))

    def values_read(self, names: Iterable[str]) -> dict[str, Value]:
        """Those of the named variables that have been read."""
        return {name: self._values[name] for name in names if name in self._values}


def error_text(error: Mapping[str, str]) -> str:
    """Kind and message of an error, without a full stop."""
    return f"{error.get('kind')}: {error.get('text', '')}".rstrip(".: ")
