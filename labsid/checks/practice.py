"""Practice: a small new instance of a question, judged by the question's own check.

An instance is made from numbers of its own: of the student's record, variables and functions nothing is used. Where a
question asks for values, they are to be computed from a new record; where it asks for a function, its result on one
input.
"""

from collections.abc import Callable, Container, Iterator, Mapping
from copy import deepcopy
from dataclasses import replace
from typing import Any

import numpy as np

from labsid.checks.compare import kind_of
from labsid.checks.notebook_ask import PUBLIC_SEED
from labsid.checks.question import Assignment, Origin, Question
from labsid.checks.summary import FAILED, PASSED, SIGNS
from labsid.checks.values import Value, as_student_object, plain
from labsid.checks.verdict import BEYOND_RESULTS, NoAnswer, Verdict
from labsid.plots.figure_values import FigureValue
from labsid.records.record import Record

_LATER = "this call comes after the one that is practised"


class _Asked(Exception):
    """What a check asks first: a function's name and its arguments, or a variable."""

    def __init__(self, name: str, arguments: tuple[Value, ...] | None) -> None:
        super().__init__(name)
        self.name = name
        self.arguments = arguments


class _PracticeAsk:
    """Answers a check with one result, or with values by name; the calls after the first with the reference."""

    def __init__(
        self,
        record: Record | None,
        origin: Origin | None,
        known: Mapping[str, Value],
        rng: np.random.Generator,
        reference: Callable[..., Value] | None = None,
        values: Mapping[str, Value] | None = None,
        results: tuple[Value, ...] | None = None,
        answers: Container[str] | None = None,
    ) -> None:
        self.origin = origin
        self.rng = rng
        self._answers = answers
        self.known_values = known
        self.values = values
        self.instance: Mapping[str, Value] | None = None
        self.read: list[str] = []
        self._record = record
        self._reference = reference
        self._results = results

    @property
    def record(self) -> Record:
        if self._record is None:
            raise ValueError("this assignment has no record")
        return self._record

    def value(self, name: str) -> Value:
        if self.values is None:
            if self._results is not None:
                raise NoAnswer(_LATER, BEYOND_RESULTS)
            if name in self.known_values:
                return self.known_values[name]
            if self._answers is None or name in self._answers:
                raise _Asked(name, None)
            raise NoAnswer(f"`{name}` is not asked for.")
        if name in self.values:
            self.read.append(name)
            return self.values[name]
        if name in self.known_values:
            return self.known_values[name]
        raise NoAnswer(f"`{name}` is missing: hand it over by its name, `{name}=...`.")

    def call(self, name: str, *arguments: Value) -> Value:
        if self.values is not None:
            raise NoAnswer(f"`{name}` is not asked for here.")
        if self._results is None:
            raise _Asked(name, arguments)
        if self._results:
            result, *self._results = self._results  # type: ignore[assignment]
            return result
        if self._reference is None:
            raise NoAnswer(_LATER, BEYOND_RESULTS)
        return plain(self._reference(*arguments))

    def changes(self, name: str, *arguments: Value) -> bool:
        return False  # there are results alone

    def known(self, name: str) -> Value:
        return self.known_values[name]


class Exercise:
    """A small instance of a question: its given values are attributes, `check` judges an answer, `solution` gives one.

    Parameters
    ----------
    question : Question
    text : str
        What is asked.
    given : mapping
        The given values, by name.
    answers : tuple of str
        The names of the values that are asked for; empty where the result of a function is.
    judged : callable
        ``judged(values or result)`` is the verdict.
    right : callable or None
        The right values, by name, or the right result; None where only the check knows what is right.
    """

    def __init__(
        self,
        question: Question,
        text: str,
        given: Mapping[str, Any],
        answers: tuple[str, ...],
        judged: Callable[[Any], Verdict],
        right: Callable[[], Any] | None,
    ) -> None:
        self._question = question
        self._text = text
        self.answers = answers
        self._judged = judged
        self._right = right
        self.given = tuple(given)
        self.has_solution = right is not None
        for name, value in given.items():
            setattr(self, name, value)

    def __str__(self) -> str:
        lines = [f"{self._question.id}, with new numbers. Name the exercise: p = check.practice(...). Given:"]
        lines += [f"  p.{name} {_said(getattr(self, name))}" for name in self.given]
        return "\n".join([*lines, self._text])

    __repr__ = __str__

    def check(self, *results: Any, **values: Any) -> None:
        """Judge an answer: one result, or the values that are asked for, by name or in their order."""
        if self.answers:
            values = {**dict(zip(self.answers, results, strict=False)), **values}
            verdict = self._judged({name: plain(value) for name, value in values.items()})
        elif results:
            verdict = self._judged(plain(results[0] if len(results) == 1 else results))
        else:
            verdict = Verdict(False, "hand over what the function should return: p.check(result).")
        state = PASSED if verdict.passed else FAILED
        print(f"{SIGNS[state]} {verdict.whole_reason or 'this is right.'}")

    def solution(self) -> Any:
        """What is right for these numbers, where more than the check knows it."""
        if self._right is None:
            print("Only the check knows: compare with your own function, line by line.")
            return None
        return self._right()


def questions_with_practice(assignment: Assignment) -> Iterator[Question]:
    """The questions that have numbers to practise with."""
    for question in assignment.questions:
        if exercise_of(assignment, question, 0) is not None:
            yield question


def exercise_of(assignment: Assignment, question: Question, number: int) -> Exercise | None:
    """The `number`-th instance of a question; None if it has no numbers to practise with."""
    rng = np.random.default_rng([PUBLIC_SEED, number, *question.id.encode()])
    question = replace(question, judge=question.judge_first or question.judge)
    origin = None if assignment.practice_origin is None else assignment.practice_origin(deepcopy(rng))
    record = None if assignment.practice_record is None else assignment.practice_record(rng)
    known = _known_before(assignment, question, record, rng)
    if question.gives is None and record is not None and assignment.practice_given is not None:
        known = {**assignment.practice_given(record), **known}

    def ask(**answer: Any) -> _PracticeAsk:
        made = _PracticeAsk(record, origin, deepcopy(known), deepcopy(rng), question.reference, **answer)
        if question.instance is not None:
            made.instance = question.instance(made)
            made.known_values = {**made.known_values, **(made.instance or {})}
        return made

    first = ask(values={})
    if question.instance is not None and first.instance is None:
        return None
    right = {} if question.gives is None else dict(question.gives(first))
    given_before = {} if assignment.practice_given is None else dict(assignment.practice_given(first.record))
    given = {**given_before, **first.known_values} if first.instance is None else dict(first.instance)
    answers = None if question.gives is None else right.keys() - first.known_values.keys()
    asked = _first_asked(question, ask(answers=answers))
    if asked is None:
        return None
    if asked.arguments is not None:
        return _call(question, ask, {**given_before, **first.known_values} if given_before else {}, asked)
    facts = {} if origin is None or assignment.practice_facts is None else assignment.practice_facts(origin)
    if asked.name in facts:
        return _values(question, ask, given, {asked.name: facts[asked.name]})
    if answers is None:
        return _without_solution(question, ask, given, asked.name)
    return _values(question, ask, given, right)


def _first_asked(question: Question, ask: _PracticeAsk) -> _Asked | None:
    """What a check asks first; None if it asks for nothing, as without a record."""
    try:
        question.judge(ask)
    except _Asked as asked:
        return asked
    except (NoAnswer, ValueError, KeyError):
        return None
    return None


def _known_before(
    assignment: Assignment, question: Question, record: Record | None, rng: np.random.Generator
) -> dict[str, Value]:
    """The right values of the questions before this one, on the instance's record."""
    known: dict[str, Value] = {}
    for one in assignment.questions:
        if one.id == question.id:
            break
        if one.gives is not None and (record is not None or assignment.record_file is None):
            known.update(one.gives(_PracticeAsk(record, None, dict(known), rng, values={})))
    return known


def _call(question: Question, ask: Callable[..., _PracticeAsk], before: Mapping[str, Value], asked: _Asked) -> Exercise:
    arguments = asked.arguments or ()
    handed = {f"x{i}": value for i, value in enumerate(arguments, 1)}
    given = {name: as_student_object(value) for name, value in {**before, **handed}.items()}

    def judged(result: Value) -> Verdict:
        verdict = question.verdict(ask(results=(result,)))
        if _LATER not in verdict.reason:
            return verdict
        if _LATER in question.verdict(ask(results=(_moved(result),))).reason:
            return Verdict(False, "this cannot be judged from one result: run the check of the notebook.")
        return Verdict(True, "this is right.")

    call = f"{asked.name}({', '.join(f'p.{name}' for name in handed)})"
    text = f"What does `{call}` return if it is right? Work it out, then run p.check(result)."
    reference = question.reference
    right = None if reference is None else lambda: reference(*arguments)
    return Exercise(question, text, given, (), judged, right)


def _values(
    question: Question, ask: Callable[..., _PracticeAsk], given: Mapping[str, Value], right: Mapping[str, Value]
) -> Exercise | None:
    solved = ask(values=right)
    question.verdict(solved)
    names = tuple(name for name in dict.fromkeys(solved.read) if name not in solved.known_values)
    if not names:
        return None

    def judged(values: Mapping[str, Value]) -> Verdict:
        return question.verdict(ask(values=values))

    def solution() -> dict[str, Any]:
        return {name: as_student_object(right[name]) for name in names}

    wanted = ", ".join(f"{name}=..." for name in names)
    text = f"Find {' and '.join(names)} as in the step, then run p.check({wanted})."
    objects = {name: as_student_object(value) for name, value in given.items()}
    return Exercise(question, text, objects, names, judged, solution)


def _without_solution(
    question: Question, ask: Callable[..., _PracticeAsk], given: Mapping[str, Value], name: str
) -> Exercise:
    """An exercise whose answer has many right forms, such as a figure: its check alone judges it."""

    def judged(values: Mapping[str, Value]) -> Verdict:
        return question.verdict(ask(values=values))

    text = f"Make {name} of these data as in the step, then run p.check({name}=...)."
    objects = {key: as_student_object(value) for key, value in given.items()}
    return Exercise(question, text, objects, (name,), judged, None)


def _moved(result: Value) -> Value:
    """A result of the same form with other numbers, which a check that has judged the result refuses."""
    if isinstance(result, tuple | list):
        return type(result)(map(_moved, result))
    return 1.3 * result + 1 if isinstance(result, int | float | np.ndarray) else None


def _said(value: Any) -> str:
    """A given value: short ones as numbers, long ones as their shape."""
    array = np.asarray(value) if isinstance(value, np.ndarray | list | tuple) else None
    if array is not None and array.size <= 12 and array.dtype.kind in "biuf":
        return f"= {np.array2string(array, precision=4, separator=', ').replace(chr(10), ' ')}"
    if isinstance(value, float | int | np.number):
        return f"= {value:.6g}"
    kind = plain(value)
    return "is a figure" if isinstance(kind, FigureValue) else f"is {kind_of(kind)}"
