"""Values that no step asks for, in the place of right ones: does any check end with an internal error?

Each variable that a check reads, and each result of a function that it calls, is replaced by a mutation of the right
one: other types, shapes and sizes, numbers that are none, and small changes. A check may say that the answer is wrong,
or that it is right; it must not raise. Run with ``python tests/mutated_values.py --cases 1000``.
"""

import argparse
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from one_answer import Solved, quietly, solve

from labsid.checks.notebook import NotebookAsk, assignment_names
from labsid.checks.question import Question, given_values
from labsid.checks.values import StateSpaceValue, TransferFunctionValue, Unreadable, Value, plain
from labsid.checks.verdict import NoAnswer

ONE = np.ones(1)
ODD: tuple[Any, ...] = (
    None,
    True,
    0,
    -1,
    3,
    2**62,
    1.5,
    0.0,
    np.nan,
    np.inf,
    -np.inf,
    1e308,
    5e-324,
    1j,
    complex("nan"),
    "",
    "abc",
    (),
    {},
    {"a": 1.0},
    (1, "a"),
    ((), ()),
    np.empty(0),
    np.empty((0, 4)),
    np.empty((3, 0)),
    np.array(2.0),
    np.array(np.nan),
    np.ones(1),
    np.ones((1, 1)),
    np.ones((2, 2, 2)),
    np.array([True, False]),
    np.array([1, 2, 3]),
    np.array([1j, 2.0]),
    np.full(5, np.nan),
    np.full(700, np.inf),
    np.full((4, 4), np.nan),
    np.zeros(1000),
    np.float32(1.5),
    np.ones(3, np.float16),
    np.ones(3, np.longdouble),
    np.zeros((5, 5)),
    Unreadable("generator"),
    Unreadable("array of object"),
    TransferFunctionValue(ONE, np.zeros(2), 1.0),
    TransferFunctionValue(np.empty(0), np.empty(0), None),
    TransferFunctionValue(np.full(3, np.nan), np.array([1.0, np.inf]), 0.75),
    TransferFunctionValue(ONE, ONE, -1.0),
    TransferFunctionValue(np.array([1e300, 1.0]), np.array([1.0, -1e300, 1e300]), 0.75),
    StateSpaceValue(np.eye(2), np.ones((3, 1)), np.ones((1, 1)), np.ones((1, 1)), 1.0),
    StateSpaceValue(np.full((2, 2), np.nan), np.ones((2, 1)), np.ones((1, 2)), np.zeros((1, 1)), None),
    StateSpaceValue(np.empty((0, 0)), np.empty((0, 1)), np.empty((1, 0)), np.zeros((1, 1)), 0.75),
    StateSpaceValue(1e200 * np.eye(2), np.ones((2, 1)), np.ones((1, 2)), np.zeros((1, 1)), 0.75),
)
"""Values of every kind that a check can be handed."""


def _at_one_place(value: Any, number: Any, rng: np.random.Generator) -> Any:
    changed = np.array(value, dtype=complex if isinstance(number, complex) else float)
    if changed.size:
        changed.flat[int(rng.integers(changed.size))] = number
    return changed


ARRAYS: tuple[Callable[[Any, np.random.Generator], Any], ...] = (
    lambda a, rng: a.T,
    lambda a, rng: a.ravel(),
    lambda a, rng: a.reshape(-1, 1),
    lambda a, rng: a.reshape(1, -1),
    lambda a, rng: a[::-1],
    lambda a, rng: -a,
    lambda a, rng: 0 * a,
    lambda a, rng: 1e300 * a,
    lambda a, rng: 1e-300 * a,
    lambda a, rng: a[: a.shape[0] // 2],
    lambda a, rng: a[:-1],
    lambda a, rng: a[1:],
    lambda a, rng: a[:1],
    lambda a, rng: a[:0],
    lambda a, rng: np.concatenate([a, a]),
    lambda a, rng: np.concatenate([a, a[:1]]),
    lambda a, rng: a.astype(np.float32),
    lambda a, rng: a.astype(np.float16),
    lambda a, rng: np.asarray(a.real).astype(int),
    lambda a, rng: a.astype(complex),
    lambda a, rng: a > 0,
    lambda a, rng: a.astype(np.longdouble),
    lambda a, rng: a + rng.normal(size=a.shape),
    lambda a, rng: a * (1 + 1e-9 * rng.normal(size=a.shape)),
    lambda a, rng: np.roll(a, int(rng.integers(1, 9)), axis=0),
    lambda a, rng: np.full(a.shape, a.flat[0]),
    lambda a, rng: np.cumsum(a, axis=0),
    lambda a, rng: np.stack([a, a]),
    lambda a, rng: np.stack([a, a], axis=-1),
    lambda a, rng: _at_one_place(a, np.nan, rng),
    lambda a, rng: _at_one_place(a, np.inf, rng),
    lambda a, rng: _at_one_place(a, 1e308, rng),
    lambda a, rng: _at_one_place(a, 1j, rng),
    lambda a, rng: _at_one_place(a, 0.0, rng),
    lambda a, rng: np.full(a.shape, np.nan),
    lambda a, rng: a**2,
    lambda a, rng: a.tolist(),
    lambda a, rng: rng.permutation(a),
    lambda a, rng: a[..., None],
)
"""Changes of an array."""

NUMBERS: tuple[Callable[[Any], Any], ...] = (
    lambda x: -x,
    lambda x: x + 1,
    lambda x: x - 1,
    lambda x: 0 * x,
    lambda x: x * 1e300,
    lambda x: x * 1e-300,
    lambda x: complex(x),
    lambda x: np.array([x]),
    lambda x: np.array([[x]]),
    lambda x: np.float32(x),
    lambda x: str(x),
    lambda x: (x, x),
    lambda x: x * (1 + 1e-9),
    lambda x: 1 / x,
    lambda x: x * np.nan,
    lambda x: x * np.inf,
    lambda x: x**2,
    lambda x: np.full(700, x),
)
"""Changes of a number."""


def mutated(value: Value, rng: np.random.Generator, depth: int = 0) -> Value:
    """A mutation of a value."""
    if depth == 0 and rng.random() < 0.3:
        return plain(ODD[int(rng.integers(len(ODD)))])
    with np.errstate(all="ignore"):
        try:
            return _changed(value, rng, depth)
        except (ArithmeticError, ValueError, TypeError, IndexError):  # there is no such change of this value
            return plain(ODD[int(rng.integers(len(ODD)))])


def _changed(value: Value, rng: np.random.Generator, depth: int) -> Value:
    if isinstance(value, np.ndarray) and value.ndim:
        return plain(ARRAYS[int(rng.integers(len(ARRAYS)))](value, rng))
    if isinstance(value, int | float | complex | np.ndarray):
        return plain(NUMBERS[int(rng.integers(len(NUMBERS)))](value.item() if isinstance(value, np.ndarray) else value))
    if isinstance(value, tuple | list) and len(value):
        return _changed_parts(list(value), rng, depth)
    if isinstance(value, Mapping) and value:
        key = str(rng.choice(sorted(value)))
        left = {name: one for name, one in value.items() if name != key}
        return left if rng.random() < 0.3 else {**left, key: mutated(value[key], rng, depth)}
    if isinstance(value, str):
        return str(rng.choice(["", value.upper(), value[::-1], value + "x", "a" * 5000, "\x00", "é\n"]))
    if is_dataclass(value) and not isinstance(value, Unreadable | type):
        names = [one.name for one in fields(value)]
        name = str(rng.choice(names))
        return replace(value, **{name: _of_the_same_kind(getattr(value, name), rng)})  # type: ignore[arg-type]
    return plain(ODD[int(rng.integers(len(ODD)))])


def _changed_parts(parts: list[Any], rng: np.random.Generator, depth: int) -> Value:
    at = int(rng.integers(len(parts)))
    match int(rng.integers(6)):
        case 0:
            del parts[at]
        case 1:
            parts.append(parts[at])
        case 2:
            parts.reverse()
        case _:
            parts[at] = mutated(parts[at], rng, depth + (rng.random() < 0.5))
    return plain(tuple(parts))


FIXED = ("color", "xlim", "ylim")
"""Fields of a figure with a number of parts that the channel ensures."""


def _of_the_same_kind(value: Any, rng: np.random.Generator) -> Any:
    """Another value of a field of a system or a figure, whose types the channel ensures."""
    if isinstance(value, np.ndarray) and value.ndim:
        for _ in range(10):
            other = np.asarray(ARRAYS[int(rng.integers(len(ARRAYS)))](value, rng))
            if other.ndim == value.ndim and other.dtype.kind in "biuf":
                return other.astype(value.dtype)
        return value
    if isinstance(value, tuple) and value:
        at = int(rng.integers(len(value)))
        rest = (*value[:at], *value[at + 1 :])
        if rng.random() < 0.3:
            return rest
        if rng.random() < 0.3:
            return (*value, value[at])
        return (*value[:at], _of_the_same_kind(value[at], rng), *value[at + 1 :])
    if isinstance(value, bool):
        return not value
    if isinstance(value, float):
        return float(rng.choice([0.0, -value, 1e308, np.nan, np.inf, 5e-324]))
    if isinstance(value, str):
        return str(rng.choice(["", "x", value + " s", value[::-1], "$\\alpha$", "1e400"]))
    if is_dataclass(value) and not isinstance(value, type):
        name = str(rng.choice([one.name for one in fields(value)]))
        old = getattr(value, name)
        if name in FIXED:
            return replace(value, **{name: tuple(_of_the_same_kind(float(one), rng) for one in old)})
        return replace(value, **{name: _of_the_same_kind(old, rng)})
    return value


class MutatingAsk(NotebookAsk):
    """Asks the model solution, and changes what it answers."""

    mutation: np.random.Generator
    share = 1.0
    origin: Any = None

    def value(self, name: str) -> Value:
        """The variable, changed or not."""
        return self._maybe(super().value(name))

    def call(self, name: str, *arguments: Value) -> Value:
        """The result, changed or not."""
        return self._maybe(super().call(name, *arguments))

    def _maybe(self, value: Value) -> Value:
        return mutated(value, self.mutation) if self.mutation.random() < self.share else value


def failures(
    solved: Solved, question: Question, cases: int, seconds: float, seed: int = 0
) -> Iterator[tuple[int, str]]:
    """The cases in which a check of a question, or what it gives to later ones, ends with an internal error.

    Parameters
    ----------
    solved : Solved
    question : Question
    cases : int
    seconds : float
        After which no other case is begun.
    seed : int
        Of the first case.

    Yields
    ------
    tuple
        The seed of the case, and the error with the place of its last lines.
    """
    variables = solved.kept[question.id].variables(["plt"])
    end = time.monotonic() + seconds
    for number in range(seed, seed + cases):
        if time.monotonic() > end:
            return
        rng = np.random.default_rng([number, *question.id.encode()])
        ask = MutatingAsk(variables, solved.record, solved.known[question.id], question.id)
        ask.origin, ask.mutation, ask.share = solved.origin, rng, float(rng.choice([1.0, 0.5, 0.2]))
        try:
            with quietly():
                passed = question.verdict(ask).passed
                given_values(question, ask, passed=passed)
        except NoAnswer:  # of `gives`: there is no right value that follows
            continue
        except Exception as error:
            where = traceback.extract_tb(error.__traceback__)
            lines = " < ".join(f"{Path(one.filename).name}:{one.lineno}" for one in reversed(where[-4:]))
            yield number, f"{type(error).__name__}: {str(error)[:100]} at {lines}"


def main() -> int:
    """Print the errors of all questions."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=1000, help="for each question")
    parser.add_argument("--seconds", type=float, default=60.0, help="the most for each question")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="questions whose id contains this")
    options = parser.parse_args()
    count = 0
    for name in assignment_names():
        solved = solve(name)
        for question in solved.assignment.questions:
            if options.only not in question.id:
                continue
            start = time.monotonic()
            found = list(failures(solved, question, options.cases, options.seconds, options.seed))
            count += len(found)
            print(f"{question.id}: {len(found)} errors, {time.monotonic() - start:.1f} s", flush=True)
            for text, times in Counter(text for _, text in found).most_common(6):
                first = next(number for number, other in found if other == text)
                print(f"    {times} times, first --seed {first}: {text}", flush=True)
    return min(count, 1)


if __name__ == "__main__":
    sys.exit(main())
