"""One question of an assignment, and what it may ask of the student's work."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from labsid.checks.compare import kind_of
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Verdict
from labsid.records.record import Record


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a record comes from that holds something withheld: whoever knows this can make the rig again.

    Attributes
    ----------
    student : str
        The ID that it was made for.
    secret : bytes
        The secret that it was made from.
    """

    student: str
    secret: bytes = field(repr=False)


class Ask(Protocol):
    """What a check can ask. In the notebook it is backed by the student's variables, at grading by their process."""

    @property
    def record(self) -> Record:
        """The record that the student works on."""

    @property
    def origin(self) -> Origin | None:
        """Where the record comes from; None in the notebook, as the judge alone knows."""

    @property
    def rng(self) -> np.random.Generator:
        """Source of the inputs on which functions are tried; the judge's seed is not the notebook's."""

    def value(self, name: str) -> Value:
        """The student's variable; raises `NoAnswer` where there is none."""

    def call(self, name: str, *arguments: Value) -> Value:
        """What the student's function returns; raises `NoAnswer` where it does not."""

    def known(self, name: str) -> Value:
        """A value of an earlier step: the student's where it was right, the reference's where it was not."""


@dataclass(frozen=True, slots=True)
class Question:
    """One question: one check cell of a notebook, one line in the grades.

    Attributes
    ----------
    id : str
        The grade_id of its cell.
    judge : callable
        ``judge(ask) -> Verdict``; may raise `NoAnswer`.
    gives : callable or None
        ``gives(ask) -> {name: value}``: the right values of the variables that later steps start from. Where the
        answer is wrong, the later steps are judged from these (error carried forward).
    uses : tuple of str
        Ids of the questions whose variables this one starts from.
    """

    id: str
    judge: Callable[[Ask], Verdict]
    gives: Callable[[Ask], dict[str, Value]] | None = None
    uses: tuple[str, ...] = ()

    def verdict(self, ask: Ask) -> Verdict:
        """Judge, with a missing or unreadable answer as the failed verdict that it is."""
        try:
            return self.judge(ask)
        except NoAnswer as nothing:
            return Verdict(False, str(nothing), nothing.slip)


@dataclass(frozen=True, slots=True)
class Assignment:
    """An assignment's automatic questions, in the order of the notebook.

    Attributes
    ----------
    name : str
        As in ``notebooks/<name>``.
    questions : tuple of Question
        In the order in which the notebook asks them.
    record_file : str or None
        Name of the data file beside the notebook, None without one.
    """

    name: str
    questions: tuple[Question, ...]
    record_file: str | None = None

    def question(self, question_id: str) -> Question:
        """The question with that id; `ValueError` lists the ids there are."""
        for question in self.questions:
            if question.id == question_id:
                return question
        ids = ", ".join(question.id for question in self.questions)
        raise ValueError(f"{self.name} has no question {question_id!r}; it has {ids}.")


def returned(ask: Ask, name: str, *arguments: Value) -> Value:
    """What a student's function returns; a function without `return` is told so."""
    value = ask.call(name, *arguments)
    if value is None:
        raise NoAnswer(f"`{name}` returns nothing: end it with `return` and the result.", "no return")
    return value


def returned_parts(ask: Ask, name: str, wanted: str, count: int, *arguments: Value) -> list[Value]:
    """What a student's function returns, as its `count` parts; equal shapes may have been stacked to one array."""
    value = returned(ask, name, *arguments)
    parts = tuple(value) if isinstance(value, np.ndarray) and value.ndim else value
    if isinstance(parts, (tuple, list)) and len(parts) == count:
        return list(parts)
    raise NoAnswer(f"`{name}` should return {wanted}; it returns {kind_of(value)}.", "not all that was asked for")


def given_values(question: Question, ask: Ask, passed: bool) -> Mapping[str, Value]:
    """The values that later steps start from after `question`: the student's own where it passed."""
    if question.gives is None:
        return {}
    right = question.gives(ask)
    if not passed:
        return right
    kept: dict[str, Value] = {}
    for name, value in right.items():
        try:
            kept[name] = ask.value(name)
        except NoAnswer:
            kept[name] = value
    return kept
