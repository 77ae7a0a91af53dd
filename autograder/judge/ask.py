"""The interface between checks and a student's process."""

import hashlib
import hmac
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from autograder.judge.redaction import redact, redact_error
from autograder.judge.stopped import explained
from autograder.sandbox.isolation import Reply, StudentProcess
from labsid.checks.answer_code import function_in
from labsid.checks.question import Origin
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer
from labsid.records.record import Record


class CallDeferred(BaseException):
    """A check calls a function while calls are deferred; not an `Exception`, which a check may catch."""


class ProcessAsk:
    """Answers a check from a student's process, redacted for the author of `source`, the notebook.

    Parameters
    ----------
    process : callable
        Returns the process in which the variables are.
    record : Record or None
    known : mapping
        Values of earlier steps.
    rng : Generator
        Draws the inputs on which functions are tried.
    origin : Origin or None
    source : str
        The student's cells.
    values : dict
        The variables read so far: a variable is read only once for a question, because a student's object can change
        its answer.
    defer_calls : bool
        Whether to raise `CallDeferred` instead of calling a function, which would receive hidden inputs.
    as_columns : bool
        Whether to read flat vectors and rows as columns: the shape of an earlier answer is wrong, and costs only that.

    Attributes
    ----------
    got_nothing : bool
        Whether a variable or a function was missing, or a call stopped with an error.
    """

    def __init__(
        self,
        process: Callable[[], StudentProcess],
        record: Record | None,
        known: Mapping[str, Value],
        rng: np.random.Generator,
        origin: Origin | None = None,
        source: str = "",
        values: dict[str, Value] | None = None,
        defer_calls: bool = False,
        as_columns: bool = False,
    ) -> None:
        self._process = process
        self._record = record
        self._known = known
        self._source = source
        self._values = {} if values is None else values
        self._defer_calls = defer_calls
        self._as_columns = as_columns
        self.rng = rng
        self.origin = origin
        self.got_nothing = False

    @property
    def record(self) -> Record:
        """The student's record."""
        if self._record is None:
            raise ValueError("this assignment has no record")
        return self._record

    def value(self, name: str) -> Value:
        """The variable as plain data."""
        if name not in self._values:
            reply = self._reply(self._process().value(name))
            if reply.error is not None:
                raise NoAnswer(f"`{name}` cannot be read ({error_text(redact_error(reply.error, self._source))}).")
            if not reply.ok:
                raise NoAnswer(f"There is no variable `{name}`: it is not defined.")
            self._values[name] = redact(reply.value, self._source)
        return self._shaped(self._values[name])

    def call(self, name: str, *arguments: Value) -> Value:
        """The return value of the function, as plain data."""
        if self._defer_calls:
            raise CallDeferred
        reply = self._reply(self._process().call(name, *arguments))
        if reply.error is not None:
            said = f"`{name}` stopped with {error_text(redact_error(reply.error, self._source))}."
            raise NoAnswer(f"{said} {explained(reply.error, self._source)}".rstrip())
        if not reply.ok:
            raise NoAnswer(f"There is no function `{name}`: it is not defined.")
        return redact(reply.value, self._source)

    def source_of(self, name: str = "") -> str:
        """The code of the function of that name in the notebook; empty if it has none."""
        return function_in(self._source, name) if name else ""

    def changes(self, name: str, *arguments: Value) -> bool:
        """Whether the function changes an array that it is given."""
        if self._defer_calls:
            raise CallDeferred
        reply = self._process().changes(name, *arguments)
        return reply.ok and reply.value is True

    def known(self, name: str) -> Value:
        """A value of an earlier step."""
        return self._known[name]

    def _reply(self, reply: Reply) -> Reply:
        self.got_nothing |= not reply.ok
        return reply

    def _shaped(self, value: Value) -> Value:
        is_vector = isinstance(value, np.ndarray) and value.size > 1 and value.size == max(value.shape)
        return value.reshape(-1, 1) if self._as_columns and is_vector else value  # type: ignore[union-attr]


@dataclass(frozen=True, slots=True)
class AskOpener:
    """Opens a `ProcessAsk` for a question of one submission.

    Attributes
    ----------
    student, assignment : str
    source : str
        The student's cells.
    record : Record or None
    origin : Origin or None
    secret : bytes
        With the student and the question, it seeds the inputs on which functions are tried.
    """

    student: str
    assignment: str
    source: str
    record: Record | None
    origin: Origin | None
    secret: bytes = field(repr=False)

    def open(
        self,
        question_id: str,
        process: Callable[[], StudentProcess],
        known: Mapping[str, Value],
        values: dict[str, Value] | None = None,
        defer_calls: bool = False,
        as_columns: bool = False,
    ) -> ProcessAsk:
        """An ask for a question; the inputs that it draws are the same each time."""
        identity = f"{self.student}\0{self.assignment}\0{question_id}".encode(errors="surrogatepass")
        rng = np.random.default_rng(list(hmac.new(self.secret, identity, hashlib.sha256).digest()))
        return ProcessAsk(
            process, self.record, known, rng, self.origin, self.source, values, defer_calls, as_columns
        )  # fmt: skip


def error_text(error: Mapping[str, str]) -> str:
    """Kind and message of an error, without a full stop."""
    return f"{error.get('kind')}: {error.get('text', '')}".rstrip(".: ")
