"""Checks that students run in the cells of a notebook."""

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from labsid.checks.question import Assignment, given_values
from labsid.checks.values import Value, plain
from labsid.checks.verdict import NoAnswer
from labsid.records.record import Record, load_record

PUBLIC_SEED = 2018


class CheckFailed(Exception):
    """A check that did not pass. Jupyter shows only its text, on one line and without a traceback."""

    def _render_traceback_(self) -> list[str]:
        return [f"✗ {' '.join(str(self).split())}"]


class notebook_checks:  # noqa: N801  (called like a function, once, at the top of a notebook)
    """Open the checks of one assignment on the variables of a notebook.

    Parameters
    ----------
    assignment : str
        Name of the assignment, such as ``"lab-identification"``.
    variables : mapping
        The notebook's own variables: pass ``globals()``.
    record : str, Path or None
        Data file; None for the file that the assignment names.

    Raises
    ------
    ValueError
        If there is no such assignment, or its record cannot be read.

    Examples
    --------
    ``check = notebook_checks("lab-identification", globals())`` once, then ``check("lab-1c-offset")`` after a step.
    """

    def __init__(self, assignment: str, variables: Mapping[str, Any], record: str | Path | None = None) -> None:
        self._assignment = load_assignment(assignment)
        path = record or self._assignment.record_file
        self._record = None if path is None else load_record(path)
        self._variables = variables
        self._passed: dict[str, Mapping[str, Value]] = {}

    def __call__(self, question_id: str) -> None:
        """Check one question and print the result; raise `CheckFailed` with the reason if it is wrong."""
        question = self._assignment.question(question_id)
        waiting = [used for used in question.uses if used not in self._passed]
        if waiting:
            raise CheckFailed(f"{question_id} starts from {waiting[0]}: run that check first, until it passes.")
        known = {name: value for values in self._passed.values() for name, value in values.items()}
        ask = NotebookAsk(self._variables, self._record, known, question_id)
        verdict = question.verdict(ask)
        if not verdict.passed:
            self._passed.pop(question_id, None)
            raise CheckFailed(f"{question_id}: {verdict.reason}")
        self._passed[question_id] = given_values(question, ask, passed=True)
        print(f"✓ {question_id}: {verdict.reason}")


class NotebookAsk:
    """Asks the variables of a notebook, in the notebook's own process."""

    origin: None = None

    def __init__(
        self, variables: Mapping[str, Any], record: Record | None, known: Mapping[str, Value], question_id: str
    ) -> None:
        self._variables = variables
        self._record = record
        self._known = known
        self.rng = np.random.default_rng([PUBLIC_SEED, *question_id.encode()])

    @property
    def record(self) -> Record:
        """The record beside the notebook."""
        if self._record is None:
            raise ValueError("this assignment has no data file")
        return self._record

    def value(self, name: str) -> Value:
        """The variable as plain data."""
        if name not in self._variables:
            raise NoAnswer(f"there is no variable `{name}` yet. Define it with exactly this name.")
        return plain(self._variables[name])

    def call(self, name: str, *arguments: Value) -> Value:
        """The result of the function of that name, as plain data."""
        function = self._variables.get(name)
        if not callable(function):
            raise NoAnswer(f"there is no function `{name}` yet. Define it with `def {name}(...):`.")
        try:
            return plain(function(*[np.array(a) if isinstance(a, np.ndarray) else a for a in arguments]))
        except Exception as error:
            raise NoAnswer(f"`{name}` stopped with {type(error).__name__}: {error}") from error

    def known(self, name: str) -> Value:
        """A value of an earlier step whose check has passed."""
        return self._known[name]


def load_assignment(name: str) -> Assignment:
    """The automatic questions of an assignment; `ValueError` lists the valid names."""
    names = assignment_names()
    if name not in names:
        raise ValueError(f"there is no assignment {name!r}; there are {', '.join(names)}.")
    module = import_module(f"labsid.checks.assignments.{name.replace('-', '_')}")
    assignment: Assignment = module.ASSIGNMENT
    return assignment


def assignment_names() -> list[str]:
    """Names of the assignments that have checks."""
    folders = (Path(__file__).parent / "assignments").glob("[a-z]*/__init__.py")
    return sorted(path.parent.name.replace("_", "-") for path in folders)
