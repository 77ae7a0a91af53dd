"""Questions of an assignment, and the access of their checks to a student's work."""

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any, Protocol, cast

import numpy as np

from labsid.checks.answer_code import code_of, nothing_returned
from labsid.checks.compare import kind_of
from labsid.checks.mended_functions import Mend, assigned_by
from labsid.checks.one_place import Place
from labsid.checks.stops import OTHERWISE, RIGHT, SHAPED
from labsid.checks.values import Value, in_double_precision
from labsid.checks.verdict import RUNS_AWAY, SINGLE_PRECISION, NoAnswer, Verdict, unnamed
from labsid.records.record import Record


@dataclass(frozen=True, slots=True)
class Origin:
    """Origin of a record with withheld properties: enough to make its rig again.

    Attributes
    ----------
    student : str
        ID of the student for whom the record was made.
    secret : bytes
        Secret from which the record was made.
    """

    student: str
    secret: bytes = field(repr=False)


class FollowsFrom(Enum):
    """What the right answer to a question follows from, and so where a value that was typed in counts."""

    DATA = "the record, or a function on unseen inputs"
    EYE = "reading by eye"
    OWN_RIG = "the student's own rig, on a new run"
    TEXT = "the text, or a record that it gives"

    @property
    def may_be_typed(self) -> bool:
        """Whether a typed-in value counts: nothing else could be asked for, or nothing else is known."""
        return self in (FollowsFrom.EYE, FollowsFrom.TEXT)


PEN = "\N{LOWER RIGHT PENCIL}"
"""The sign beside the questions at which a typed-in value counts."""


class Ask(Protocol):
    """Access to a student's work: in the notebook to its variables, at grading to the student's process."""

    @property
    def record(self) -> Record:
        """The record that the student works on."""

    @property
    def origin(self) -> Origin | None:
        """Origin of the record; None in the notebook, as only the judge knows it."""

    @property
    def rng(self) -> np.random.Generator:
        """Generator of the inputs on which functions are tried; the judge and the notebook use different seeds."""

    def value(self, name: str) -> Value:
        """The student's variable; raises `NoAnswer` if there is none."""

    def call(self, name: str, *arguments: Value) -> Value:
        """The result of the student's function; raises `NoAnswer` if the function is missing or fails."""

    def changes(self, name: str, *arguments: Value) -> bool:
        """Whether the student's function changes an array that it is given; False if it cannot be called."""

    def known(self, name: str) -> Value:
        """A value of an earlier step: the student's if it was right, otherwise the reference's."""


_MOST_MENDS = 3
"""Repairs that are tried at one error."""


class _Mended:
    """Asks the same where one line of a function, or an assignment of the cell, is mended.

    It draws no inputs from `ask`. `is_used` says whether what was mended has been asked for.
    """

    def __init__(self, ask: Ask, mend: Mend) -> None:
        self._ask, self._mend = ask, mend
        self.rng = deepcopy(ask.rng)
        self.is_used = False

    def __getattr__(self, name: str) -> Any:
        return getattr(self._ask, name)

    def value(self, name: str) -> Value:
        self.is_used |= name == assigned_by(self._mend)
        return self._ask.value_mended(self._mend, name)  # type: ignore[attr-defined]

    def call(self, name: str, *arguments: Value) -> Value:
        self.is_used = True
        return self._ask.call_mended(self._mend, name, *arguments)  # type: ignore[attr-defined]

    def changes(self, name: str, *arguments: Value) -> bool:
        return False


class _WithFunctions:
    """Asks the same, with other functions in the place of the student's."""

    def __init__(self, ask: Ask, functions: Mapping[str, Callable[..., Any]]) -> None:
        self._ask, self._functions = ask, functions
        self.rng = deepcopy(ask.rng)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._ask, name)

    def value(self, name: str) -> Value:
        return self._ask.value_with(self._functions, name)  # type: ignore[attr-defined]

    def call(self, name: str, *arguments: Value) -> Value:
        if name not in self._functions:
            raise NoAnswer(f"there is no function `{name}`.")
        return self._ask.call_function(self._functions[name], *arguments)  # type: ignore[attr-defined]

    def changes(self, name: str, *arguments: Value) -> bool:
        return False


class _InDoublePrecision:
    """Asks the same, with every number of single precision in double precision."""

    def __init__(self, ask: Ask) -> None:
        self._ask = ask

    def __getattr__(self, name: str) -> Any:
        return getattr(self._ask, name)

    def value(self, name: str) -> Value:
        return in_double_precision(self._ask.value(name))

    def call(self, name: str, *arguments: Value) -> Value:
        return in_double_precision(self._ask.call(name, *arguments))

    def known(self, name: str) -> Value:
        return in_double_precision(self._ask.known(name))


@dataclass(frozen=True, slots=True)
class Stages:
    """The hints on a question, in stages; the first is the message of its check.

    Attributes
    ----------
    where : str
        Where to look: the step, the equation, the line.
    how : str
        What to do; never the answer itself.
    """

    where: str
    how: str


@dataclass(frozen=True, slots=True)
class Question:
    """One question: a check cell of a notebook and a line in the grades.

    Attributes
    ----------
    id : str
        The grade_id of its cell.
    judge : callable
        ``judge(ask) -> Verdict``; may raise `NoAnswer`.
    gives : callable or None
        ``gives(ask) -> {name: value}``: the right values of the variables that later steps use. If the answer is
        wrong, later steps are judged from these values (error carried forward).
    uses : tuple of str
        Ids of the questions whose variables this one uses.
    follows_from : FollowsFrom
        What the answer follows from. Where it is the record, grading also runs the notebook on another one.
    reference : callable or None
        The taught function where the answer is one that is called on several inputs before any of its results is
        judged: practice answers the other calls with it.
    instance : callable or None
        ``instance(ask) -> {name: value}``: what is given to practise with, where that is not what the earlier questions
        give; None where there is nothing new to compute.
    judge_first : callable or None
        Judges the first result of the answer's function where `judge` needs more of them: practice has only one.
    """

    id: str
    judge: Callable[[Ask], Verdict]
    gives: Callable[[Ask], dict[str, Value]] | None = None
    uses: tuple[str, ...] = ()
    follows_from: FollowsFrom = FollowsFrom.DATA
    reference: Callable[..., Value] | None = None
    instance: Callable[[Ask], Mapping[str, Value] | None] | None = None
    judge_first: Callable[[Ask], Verdict] | None = None

    def verdict(self, ask: Ask) -> Verdict:
        """Judge the answer; a missing or unreadable answer fails.

        Single precision is the reason only where it leaves too few digits for the tolerance of the question.
        """
        try:
            return self._with_place(_with_lost_line(self.judge(ask), ask), ask)
        except NoAnswer as nothing:
            refused = Verdict(False, self._said(nothing, ask), nothing.slip)
        if refused.slip != SINGLE_PRECISION:
            return self._with_place(_with_lost_line(refused, ask), ask)
        try:
            verdict = self.judge(cast(Ask, _InDoublePrecision(ask)))
        except NoAnswer:
            return refused
        return verdict if verdict.passed else refused

    def _with_place(self, verdict: Verdict, ask: Ask) -> Verdict:
        """A verdict that names no mistake, with the one place of the student's functions that makes it so, if any."""
        if verdict.passed or verdict.slip not in (None, RUNS_AWAY) or not hasattr(ask, "one_place"):
            return verdict

        def passes(functions: Mapping[str, Callable[..., Any]]) -> bool:
            try:
                with unnamed():
                    return self.judge(cast(Ask, _WithFunctions(ask, functions))).passed
            except (NoAnswer, ValueError, TypeError, ArithmeticError, LookupError, AttributeError):
                return False

        place: Place | None = ask.one_place(passes)
        if place is None:
            return verdict
        mend = f"{verdict.mend} {place.mend}".strip()
        return replace(verdict, reason=f"{verdict.reason} {place.said}", mend=mend)

    def _said(self, nothing: NoAnswer, ask: Ask) -> str:
        """Why there is no answer; of the repairs of a line, those are proposed with which the answer passes."""
        if nothing.told is None or not hasattr(ask, "call_mended"):
            return str(nothing)
        return nothing.told(self.outcome_of_mends(ask))

    def outcome_of_mends(self, ask: Ask) -> Callable[[Mend], str]:
        """What says of a mend what becomes of the answer: `RIGHT`, `SHAPED` or `OTHERWISE`; see `Stop`."""
        tried: dict[Mend, str] = {}

        def outcome(mend: Mend) -> str:
            if mend not in tried:
                tried[mend] = self._outcome(ask, mend) if len(tried) < _MOST_MENDS else OTHERWISE
            return tried[mend]

        return outcome

    def _outcome(self, ask: Ask, mend: Mend) -> str:
        """What becomes of the answer when a line of it is mended."""
        asked = _Mended(ask, mend)
        try:
            verdict = self.judge(cast(Ask, asked))
        except (NoAnswer, ValueError, TypeError, ArithmeticError, LookupError):
            return OTHERWISE
        if not asked.is_used:
            return OTHERWISE
        return RIGHT if verdict.passed else SHAPED if verdict.is_shaped else OTHERWISE


@dataclass(frozen=True, slots=True)
class Assignment:
    """An assignment's automatic questions, in the order of the notebook.

    Attributes
    ----------
    name : str
        As in ``notebooks/<name>``.
    questions : tuple of Question
        In the order of the notebook.
    record_file : str or None
        Name of the data file next to the notebook; None if there is none.
    stages : mapping
        The hints of each question, by its id.
    practice_record : callable or None
        ``practice_record(rng) -> Record`` makes a small record to practise with, where the answers follow from one.
    practice_given : callable or None
        ``practice_given(record) -> {name: value}``: what the notebook's given cells make of a record.
    practice_origin : callable or None
        ``practice_origin(rng) -> Origin``: of that record, where its rig has more to ask than the record shows.
    practice_facts : callable or None
        ``practice_facts(origin) -> {name: value}``: what is asked of that rig.
    """

    name: str
    questions: tuple[Question, ...]
    record_file: str | None = None
    stages: Mapping[str, Stages] = field(default_factory=dict, hash=False)
    practice_record: Callable[[np.random.Generator], Record] | None = None
    practice_given: Callable[[Record], Mapping[str, Value]] | None = None
    practice_origin: Callable[[np.random.Generator], Origin] | None = None
    practice_facts: Callable[[Origin], Mapping[str, Value]] | None = None

    def question(self, question_id: str) -> Question:
        """The question with that id; `ValueError` lists the valid ids."""
        for question in self.questions:
            if question.id == question_id:
                return question
        ids = ", ".join(question.id for question in self.questions)
        raise ValueError(f"{self.name} has no question {question_id!r}; it has {ids}.")


def _with_lost_line(verdict: Verdict, ask: Ask) -> Verdict:
    """A verdict that does not pass, with the line of the answer that computes a value and keeps it nowhere, if any."""
    code = None if verdict.passed else code_of(ask)
    line = "" if code is None else code.kept_nowhere
    if not line or line in verdict.reason:
        return verdict
    return replace(
        verdict, reason=f"{verdict.reason} `{line}` computes a value and keeps it nowhere: `name = {line}` keeps it."
    )


def nothing_new(ask: Ask) -> None:
    """The `instance` of a question that has nothing to practise with: the text gives everything."""


def returned(ask: Ask, name: str, *arguments: Value) -> Value:
    """The result of a student's function; a function without `return` has its own message."""
    value = ask.call(name, *arguments)
    if value is None:
        raise nothing_returned(ask, name)
    return value


def returned_parts(ask: Ask, name: str, wanted: str, count: int, *arguments: Value) -> list[Value]:
    """The `count` parts of the result of a student's function; parts of equal shape may be stacked in one array."""
    return parts_of(returned(ask, name, *arguments), name, wanted, count)


def parts_of(value: Value, name: str, wanted: str, count: int) -> list[Value]:
    """The `count` parts of a result that the function of that name has returned."""
    parts = tuple(value) if isinstance(value, np.ndarray) and value.ndim else value
    if isinstance(parts, (tuple, list)) and len(parts) == count:
        return list(parts)
    raise NoAnswer(f"`{name}` should return {wanted}; it returns {kind_of(value)}.", "incomplete result")


class _WithLists:
    """Asks the same, with some arguments of each call as lists."""

    def __init__(self, ask: Ask, arguments: tuple[int, ...]) -> None:
        self._ask, self._arguments = ask, arguments

    def __getattr__(self, name: str) -> Any:
        return getattr(self._ask, name)

    def call(self, name: str, *arguments: Value) -> Value:
        handed = (
            one.tolist() if i in self._arguments and isinstance(one, np.ndarray) else one
            for i, one in enumerate(arguments)
        )
        return self._ask.call(name, *handed)


def with_lists(ask: Ask, judge: Callable[[Ask], Verdict], *arguments: int) -> Verdict:
    """Judge a function that is right for arrays where it is handed lists, as the notebook does.

    Parameters
    ----------
    ask : Ask
    judge : callable
        ``judge(ask) -> Verdict``, of one call.
    *arguments : int
        Which of the arguments are lists, counted from 0.
    """
    try:
        verdict = judge(cast(Ask, _WithLists(ask, arguments)))
    except NoAnswer as refused:
        verdict = Verdict(False, str(refused), refused.slip)
    if verdict.passed:
        return verdict
    mend = "" if "`np.array(...)`" in verdict.reason else " `np.asarray(x, float)` makes an array of a list."
    return Verdict(
        False,
        f"with arrays it is right, but with lists, which the notebook hands over as well: {verdict.reason}{mend}",
        "lists not taken",
    )


def given_values(question: Question, ask: Ask, passed: bool) -> Mapping[str, Value]:
    """The values that later steps use: the student's own if `question` passed, otherwise the right ones."""
    if question.gives is None:
        return {}
    right = question.gives(ask)
    if not passed:
        return right
    kept: dict[str, Value] = {}
    for name, value in right.items():
        try:
            kept[name] = in_double_precision(ask.value(name))
        except NoAnswer:
            kept[name] = value
    return kept
