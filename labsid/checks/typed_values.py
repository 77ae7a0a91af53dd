"""Whether values that were typed in are right on another record.

Grading runs a notebook on records that nobody has seen. In the notebook a public one takes their place. No code of the
student runs there: a typed-in value is the same on every record, and all others are taken to be right.
"""

import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from labsid.checks.other_records import another_record, can_be_drawn
from labsid.checks.question import Assignment, FollowsFrom, Question
from labsid.checks.reference_values import ReferenceAsk, find_reference_values
from labsid.checks.values import Value, plain
from labsid.checks.verdict import NoAnswer, Verdict
from labsid.records.record import Record, load_record

PUBLIC_ENTROPY = 2018
"""Seed of the record that takes the place of the hidden ones in a notebook."""


def wrong_elsewhere(
    question: Question,
    assignment: Assignment,
    record: Record | None,
    typed: Iterable[str],
    variables: Mapping[str, Any],
    call: Callable[..., Value],
) -> bool:
    """Whether an answer with these typed-in values is wrong on another record, where it is right with right values.

    Parameters
    ----------
    question : Question
    assignment : Assignment
    record : Record or None
        The student's own.
    typed : iterable of str
        Names of the typed-in values.
    variables : mapping
        The notebook's variables.
    call : callable
        Calls a function of the student's: ``call(name, *arguments)``.

    Returns
    -------
    bool
        False, too, where it cannot be told: without another record, or a right value of another variable.
    """
    name, typed = assignment.record_file, frozenset(typed)
    is_asked = question.follows_from is FollowsFrom.DATA and bool(typed)
    if not is_asked or record is None or name is None or not can_be_drawn(name):
        return False
    try:
        other_record = _public_record(name, record)
    except ValueError:
        return False
    right = find_reference_values(assignment, other_record)
    values = right.get(question.id, {})
    earlier = [asked.id for asked in assignment.questions[: assignment.questions.index(question)]]
    known = {key: value for question_id in earlier for key, value in right.get(question_id, {}).items()}
    mixed = {**known, **values} | {key: plain(variables[key]) for key in typed if key in variables}
    judged = [
        question.verdict(_AskWith(other_record, known, values_there, call))
        for values_there in ({**known, **values}, mixed)
    ]
    return judged[0].passed and not judged[1].passed


class _AskWith(ReferenceAsk):
    """Answers with these values, and with the student's functions."""

    def __init__(
        self, record: Record, known: Mapping[str, Value], values: Mapping[str, Value], call: Callable[..., Value]
    ) -> None:
        super().__init__(record, None, known)
        self._values = values
        self._call = call

    def value(self, name: str) -> Value:
        if name not in self._values:
            raise NoAnswer(f"there is no right value of `{name}`")
        return self._values[name]

    def call(self, name: str, *arguments: Value) -> Value:
        return self._call(name, *arguments)


def _public_record(name: str, own: Record) -> Record:
    with tempfile.TemporaryDirectory(prefix="labsid-") as folder:
        path = Path(folder) / name
        path.write_bytes(another_record(name, own, PUBLIC_ENTROPY))
        return load_record(path)


def told(typed: Iterable[str]) -> Verdict:
    """What a check says of typed-in values that are wrong on another record."""
    names = " and ".join(f"`{name}`" for name in sorted(typed))
    are = "are" if names.count("`") > 2 else "is"
    return Verdict(
        False,
        f"{names} {are} right on your record, but typed in, and wrong on another one. Grading also runs your notebook "
        "on another record, so this would earn nothing: compute it from the record.",
        "typed in",
    )


def told_of_wrong(typed: Iterable[str], reason: str) -> Verdict:
    """What a check says of typed-in values that are wrong, after the reason that is known."""
    names = " and ".join(f"`{name}`" for name in sorted(typed))
    are, it = ("are", "they") if names.count("`") > 2 else ("is", "it")
    return Verdict(
        False,
        f"{reason} {names} {are} typed in, and computed by no code of yours: a number from a text or of somebody else "
        f"belongs to another record. Here {it} must be computed from the variables of the steps before.",
        "typed in",
    )
