"""The right values of all questions of an assignment on a record, without any work of a student."""

from collections.abc import Mapping

import numpy as np

from labsid.checks.question import Assignment, Origin
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer
from labsid.records.record import Record


class ReferenceAsk:
    """Answers with given values and functions of nobody: there is no student's work."""

    def __init__(self, record: Record, origin: Origin | None, known: Mapping[str, Value]) -> None:
        self.record = record
        self.origin = origin
        self.rng = np.random.default_rng(0)
        self._known = known

    def value(self, name: str) -> Value:
        """There is no variable."""
        raise NoAnswer(f"there is no variable `{name}`")

    def call(self, name: str, *arguments: Value) -> Value:
        """There is no function."""
        raise NoAnswer(f"there is no function `{name}`")

    def changes(self, name: str, *arguments: Value) -> bool:
        """There is no function."""
        return False

    def known(self, name: str) -> Value:
        """A right value of an earlier step."""
        return self._known[name]


def find_reference_values(
    assignment: Assignment, record: Record, origin: Origin | None = None
) -> dict[str, dict[str, Value]]:
    """The right values of every question of an assignment on a record, by question and name.

    Parameters
    ----------
    assignment : Assignment
    record : Record
    origin : Origin, optional

    Returns
    -------
    dict
        Without the questions whose values cannot be computed there.
    """
    known: dict[str, Value] = {}
    right: dict[str, dict[str, Value]] = {}
    for question in assignment.questions:
        if question.gives is None:
            continue
        try:
            right[question.id] = question.gives(ReferenceAsk(record, origin, known))
        except Exception:  # without a reference value on this record there is nothing to compare with
            continue
        known.update(right[question.id])
    return right
