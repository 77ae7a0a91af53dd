"""Access of a check to the variables of a notebook, in the notebook's own process."""

import difflib
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import replace
from io import StringIO
from types import FunctionType
from typing import Any

import numpy as np

from labsid.checks.answer_code import ended_early
from labsid.checks.compare import kind_of
from labsid.checks.function_reads import function_text, length_beside, numbers_beside, reads_beside
from labsid.checks.mended_functions import MEND_SECONDS, Mend, assigned_by, made_by_function, mended, mended_value
from labsid.checks.one_place import Functions, Place, find_place
from labsid.checks.python_errors import explain, told
from labsid.checks.stops import stop_of
from labsid.checks.time_limit import CALL_SECONDS, OutOfTime, can_limit_time, limit_time
from labsid.checks.values import Value, plain, unchanged
from labsid.checks.verdict import PYTHON_ERROR, NoAnswer
from labsid.checks.written_calls import numbers_handed
from labsid.records.record import Record

PUBLIC_SEED = 2018
_CHANGED_SECONDS = 1.0
"""Longest call of a function in which one expression is changed; `find_place` limits them all together."""
_SMALL = 9
"""Largest number of entries that a message writes out."""


class NotebookAsk:
    """Asks the variables of a notebook, in the notebook's own process; `names` are those that were asked for.

    `source` is the code of the answer cell, where it is known. Of the last function, `tried` says how it was called
    with what result, `beside` which data of the notebook it reads.
    """

    origin: None = None

    def __init__(
        self,
        variables: Mapping[str, Any],
        record: Record | None,
        known: Mapping[str, Value],
        question_id: str,
        source: str = "",
    ) -> None:
        self._variables = variables
        self._record = record
        self._known = known
        self._source = source
        self.names: list[str] = []
        self.tried = ""
        self.beside = ""
        self._calls = 0
        self.rng = np.random.default_rng([PUBLIC_SEED, *question_id.encode()])

    @property
    def record(self) -> Record:
        """The record beside the notebook."""
        if self._record is None:
            raise ValueError("this assignment has no data file")
        return self._record

    def value(self, name: str) -> Value:
        """The variable as plain data."""
        self.names.append(name)
        self.tried = self.beside = ""
        if name not in self._variables:
            raise NoAnswer(f"there is no variable `{name}` yet. Define it with exactly this name.{self._near(name)}")
        return plain(self._variables[name])

    def call(self, name: str, *arguments: Value) -> Value:
        """The result of the function of that name, as plain data."""
        begins_with_calls = bool(self._calls) or not self.names
        self.names.append(name)
        self._calls += 1
        function = self._variables.get(name)
        if not callable(function):
            near = self._near(
                name, [variable for variable, thing in self._variables.items() if isinstance(thing, FunctionType)]
            )
            raise NoAnswer(f"there is no function `{name}` yet. Define it with `def {name}(...):`.{near}")
        said = (
            reads_beside(name, function, self._variables),
            ended_early(name, function_text(function)),
        )
        self.tried, self.beside = "", " ".join(filter(None, said))
        try:
            with limit_time(CALL_SECONDS):
                result = plain(function(*[np.array(a) if isinstance(a, np.ndarray) else a for a in arguments]))
            if begins_with_calls:
                self.beside = self.beside or numbers_beside(name, function, self._variables)
                self.tried = f"Tried: `{name}({_listed(arguments)})` returned {_short(result)}."
            return result
        except (OutOfTime, KeyboardInterrupt) as endless:
            stop = stop_of(endless, self._variables)
            raise NoAnswer(
                f"`{name}` did not come to an end within {CALL_SECONDS:g} s"
                f"{f', and was stopped in `{stop.line}`' if stop.line else ''}. {explain(stop)}"
            ) from None
        except Exception as error:
            stop = stop_of(error, self._variables)
            counts = {thing.value for thing in stop.things.values()}
            cause = "" if self.beside else length_beside(name, function, self._variables, arguments, counts)

            def with_outcome(outcome: Callable[[Mend], str] | None = None) -> str:
                return told(replace(stop, outcome=outcome), f"`{name}`", cause=cause)

            raise NoAnswer(with_outcome(), PYTHON_ERROR, with_outcome) from error

    def value_mended(self, mend: Mend, name: str) -> Value:
        """The variable as a mended line assigns it, or as it is; raises `NoAnswer` if there is none."""
        try:
            if name != assigned_by(mend):
                return plain(self._variables[name])
            with limit_time(MEND_SECONDS), redirect_stdout(StringIO()), redirect_stderr(StringIO()):
                return plain(mended_value(mend, self._variables))
        except (Exception, OutOfTime) as error:
            raise NoAnswer(f"`{name}` cannot be mended.") from error

    def call_mended(self, mend: Mend, name: str, *arguments: Value) -> Value:
        """The result of the function of that name when a line is mended; raises `NoAnswer` if it has none."""
        function = mended(name, mend, self._variables)
        if function is None:
            raise NoAnswer(f"`{name}` cannot be mended.")
        try:
            with limit_time(MEND_SECONDS), redirect_stdout(StringIO()), redirect_stderr(StringIO()):
                return plain(function(*[np.array(a) if isinstance(a, np.ndarray) else a for a in arguments]))
        except (Exception, OutOfTime) as error:
            raise NoAnswer(f"`{name}` stops also when it is mended.") from error

    def one_place(self, passes: Callable[[Functions], bool]) -> Place | None:
        """The one place of the functions asked for where another expression makes the answer right.

        ``passes(functions)`` says whether the answer passes with these functions. None where no such place is found,
        or where a function that does not end could not be stopped.
        """
        if not can_limit_time():
            return None
        kept = self.names[:], self.tried, self.beside
        try:
            with redirect_stdout(StringIO()), redirect_stderr(StringIO()), _quiet_libraries():
                return find_place(kept[0], self._variables, passes)
        finally:
            self.names[:], self.tried, self.beside = kept

    def call_function(self, function: Callable[..., Any], *arguments: Value) -> Value:
        """The result of a changed function, as plain data; raises `NoAnswer` if it has none."""
        try:
            with limit_time(_CHANGED_SECONDS):
                return plain(function(*[np.array(a) if isinstance(a, np.ndarray) else a for a in arguments]))
        except (Exception, OutOfTime) as error:
            raise NoAnswer("the function stops.") from error

    def value_with(self, functions: Functions, name: str) -> Value:
        """The variable as the answer makes it with changed functions, or as it is; raises `NoAnswer` if it has none."""
        made = made_by_function(name, self._source, functions)
        if made is None:
            return self.value(name)
        try:
            with limit_time(_CHANGED_SECONDS):
                return plain(eval(made, {**self._variables, **functions}))
        except (Exception, OutOfTime) as error:
            raise NoAnswer(f"`{name}` is not made.") from error

    def numbers_handed(self, function: str, name: str) -> tuple[float | None, ...]:
        """The numbers that the notebook hands over to its function of that name, in the call that makes a variable."""
        return numbers_handed(self._variables.get(function), name, self._variables)

    def source_of(self, name: str = "") -> str:
        """The code of the function of that name, or of the answer cell; empty where Python does not keep it."""
        return function_text(self._variables.get(name)) if name else self._source

    def changes(self, name: str, *arguments: Value) -> bool:
        """Whether the function of that name changes an array that it is given."""
        function = self._variables.get(name)
        if not callable(function):
            return False
        given = [np.array(one) if isinstance(one, np.ndarray) else one for one in arguments]
        try:
            with limit_time(CALL_SECONDS):
                function(*given)
        except (Exception, OutOfTime, KeyboardInterrupt):
            return False
        return not unchanged(given, arguments)

    def _near(self, name: str, functions: Iterable[str] = ()) -> str:
        """A variable that is spelt alike but for capitals and underscores, and belongs to no earlier step.

        Or one of the `functions`, spelt nearly alike.
        """
        alike = [one for one in self._variables if _letters(one) == _letters(name) and one not in (name, *self._known)]
        near = [*alike, *difflib.get_close_matches(name, functions, 1, 0.85)]
        letters = " Capital and small letters differ." if alike else ""
        return f" There is `{near[0]}`: is that meant?{letters}" if near else ""

    def known(self, name: str) -> Value:
        """A value of an earlier step: the student's, or the reference's where that step was skipped."""
        return self._known[name]


@contextmanager
def _quiet_libraries() -> Iterator[None]:
    """Without what compiled libraries write to standard error, such as LAPACK of a matrix that holds nan."""
    try:
        kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    except OSError:
        yield
        return
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def _letters(name: str) -> str:
    return name.replace("_", "").lower()


def _listed(arguments: tuple[Value, ...]) -> str:
    return ", ".join(map(_short, arguments))


def _short(value: Value) -> str:
    """A value in a few characters: small arrays whole, longer ones by their beginning and their shape."""
    if isinstance(value, tuple | list):
        return f"({', '.join(map(_short, value[:4]))})"
    if isinstance(value, np.ndarray) and value.ndim and value.dtype.kind in "biufc":
        if value.size <= _SMALL:
            return np.array2string(value, precision=3, separator=", ", suppress_small=True).replace("\n", "")
        row = value if value.ndim == 1 else value[0]
        shown = ", ".join(f"{number:.3g}" for number in np.ravel(row)[:3])
        return f"[{shown}, ...] of shape {value.shape}"
    if isinstance(value, bool | str):
        return repr(value)[:60]
    return f"{value:.4g}" if isinstance(value, int | float) else kind_of(value)
