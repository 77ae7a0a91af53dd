"""How a wrong result is related to the right one, by a sign, a factor, an order or a shift: facts, not causes."""

from collections.abc import Callable, Iterator
from itertools import permutations
from typing import Any

import numpy as np

from labsid._arrays import FloatArray

Same = Callable[[Any, Any], bool]

_FACTORS: tuple[tuple[float, str], ...] = (
    (2.0, "twice"), (0.5, "half"), (4.0, "four times"), (0.25, "a quarter of"), (3.0, "three times"),
    (2 * np.pi, "2 pi times"), (1 / (2 * np.pi), "1/(2 pi) times"), (10.0, "ten times"), (0.1, "a tenth of"),
    (100.0, "a hundred times"), (0.01, "a hundredth of"), (1000.0, "a thousand times"), (0.001, "a thousandth of"),
    (60.0, "60 times"), (1 / 60, "a sixtieth of"), (np.log(10), "ln 10 times"), (1 / np.log(10), "1/(ln 10) times"),
    (np.sqrt(2), "the root of 2 times"), (1 / np.sqrt(2), "1/sqrt(2) times"),
)  # fmt: skip
_LARGEST_SHIFT = 3
_MOST_COLUMNS = 5
_NEAR = 1e-6
_FEWEST = 3
"""Entries from which on a common factor or shift is no chance."""


def relation(got: object, right: object, same: Same, of: str = "") -> str:
    """How `got` differs from `right`, in a sentence; empty if nothing simple relates them.

    Parameters
    ----------
    got, right : float or ndarray
        Of any shape; nothing is said of other objects, and of unequal shapes.
    same : callable
        The comparison of the question, with which they differ.
    of : str, optional
        What `got` is called; without it, it is the whole of what was asked for, "it".
    """
    said = _relation(got, right, same)
    return f"Of {of} holds: {said[0].lower()}{said[1:]}" if said and of else said


def _relation(got: object, right: object, same: Same) -> str:
    try:
        a, b = np.asarray(got, float), np.asarray(right, float)
    except (TypeError, ValueError):
        return ""
    if a.shape != b.shape or a.size == 0 or not np.all(np.isfinite(a)) or np.max(np.abs(b)) == 0:
        return ""
    if np.max(np.abs(a)) == 0:
        return "It is zero." if a.size == 1 else "All of it is zero."
    kinds = (_scaled, _changed, _reordered, _columns, _moved, _zeroed, _partly) if a.ndim else (_scaled, _changed)
    with np.errstate(all="ignore"):
        for kind in kinds:
            try:
                text = next(kind(a, b, same), "")
            except (TypeError, ValueError, IndexError):  # a comparison of other things than arrays
                continue
            if text:
                return text
    return ""


def _scaled(a: FloatArray, b: FloatArray, same: Same) -> Iterator[str]:
    whole = "It is" if a.size == 1 else "Every entry is"
    if same(-a, b):
        yield "It is right but for its sign." if a.size == 1 else "All of it is right but for the sign."
    for factor, words in _FACTORS:
        for sign in (1, -1):
            if same(a / (sign * factor), b):
                yield f"{whole} {words} the right value{', with the other sign' if sign < 0 else ''}."
    if b.size >= _FEWEST:
        factor = float(np.sum(a * b) / np.sum(b * b))
        if factor and same(a / factor, b):
            yield "All of it is the right result times one factor."
        shift = float(np.mean(a - b))
        if np.ptp(b) > 0 and same(a - shift, b):
            yield "All of it is the right result with one constant added."


def _changed(a: FloatArray, b: FloatArray, same: Same) -> Iterator[str]:
    of = "the right value" if a.size == 1 else "the right result, entry by entry"
    for words, made in (
        ("the square of", b**2),
        ("the root of", np.sqrt(np.abs(b))),
        ("the absolute value of", np.abs(b)),
        ("one over", 1 / b),
        ("the natural logarithm of", np.log(np.abs(b))),
        ("e to the power of", np.exp(b)),
    ):
        if np.all(np.isfinite(made)) and same(a, made) and not same(made, b):
            yield f"It is {words} {of}."
    for digits in range(7):
        if np.array_equal(np.round(b, digits), a) and not same(np.round(b, digits), b):
            yield f"It is rounded to {digits} digits after the point: keep all digits."


def _reordered(a: FloatArray, b: FloatArray, same: Same) -> Iterator[str]:
    if a.ndim == 1 and a.size > 1:
        if same(a[::-1], b):
            yield "The entries are right, in reverse order."
        elif same(np.sort(a), np.sort(b)):
            yield "The entries are right, in another order."
        elif a.size <= 2 * _MOST_COLUMNS and same(np.abs(a), np.abs(b)):
            wrong = ", ".join(f"[{i}]" for i in np.flatnonzero(np.sign(a) != np.sign(b)))
            yield f"The entries are right but for the sign of {wrong}."
    if a.ndim == 2 and a.shape[0] == a.shape[1] and same(a.T, b):
        yield "It is the transpose of what is right."
    if a.ndim == 2 and a.shape[0] == a.shape[1] > 1 and same(np.diag(np.diag(a)), np.diag(np.diag(b))):
        beside = "what stands beside it is not" if np.any(a - np.diag(np.diag(a))) else "and all beside it is zero"
        yield f"Its diagonal is right, {beside}."


def _columns(a: FloatArray, b: FloatArray, same: Same) -> Iterator[str]:
    if a.ndim != 2 or not 1 < a.shape[1] <= _MOST_COLUMNS:
        return
    for order in permutations(range(a.shape[1])):
        signs = np.array([1.0 if np.sum(a[:, j] * b[:, i]) >= 0 else -1.0 for i, j in enumerate(order)])
        if same(a[:, list(order)] * signs, b):
            said = []
            if list(order) != sorted(order):
                now = ", ".join(str(order.index(j)) for j in range(len(order)))
                are = "stand" if np.any(signs < 0) else "are right,"
                said.append(f"its columns {are} in another order: now {now}, counted from 0 as asked for")
            wrong = [f"`[:, {order[i]}]`" for i in np.flatnonzero(signs < 0)]
            if wrong:
                said.append(f"column {' and column '.join(wrong)} has the wrong sign")
            if said:
                yield f"{'; '.join(said)}.".capitalize()
            return


def _moved(a: FloatArray, b: FloatArray, same: Same) -> Iterator[str]:
    if len(b) < 3 * _LARGEST_SHIFT:
        return
    for k in range(1, _LARGEST_SHIFT + 1):
        samples = "one sample" if k == 1 else f"{k} samples"
        if same(a[k:], b[:-k]):
            yield f"It is right, but {samples} late."
        if same(a[:-k], b[k:]):
            yield f"It is right, but {samples} early."


def _zeroed(a: FloatArray, b: FloatArray, same: Same) -> Iterator[str]:
    """Which rows or entries are zero and should not be, where all others are right."""
    rows = (np.abs(a - b) <= _NEAR * np.max(np.abs(b))).reshape(len(b), -1).all(axis=1)
    wrong = np.flatnonzero(~rows)
    if wrong.size and rows.any() and not np.any(a[wrong]):
        one, many = ("Row", "Rows") if a.ndim == 2 else ("Entry", "Entries")
        if wrong.size == 1:
            yield f"{one} {wrong[0]} (counted from 0) is zero, and should not be; the others are right."
        elif wrong[-1] - wrong[0] == wrong.size - 1:
            yield (
                f"{many} {wrong[0]} to {wrong[-1]} (counted from 0) are zero, and should not be; the others are right."
            )


def _partly(a: FloatArray, b: FloatArray, same: Same) -> Iterator[str]:
    """Which rows or entries are wrong, where most are right; or which columns."""
    scale = np.max(np.abs(b))
    near = np.abs(a - b) <= _NEAR * scale
    if a.ndim == 2:
        bad = [f"`[:, {j}]`" for j in np.flatnonzero(~near.all(axis=0))]
        if len(bad) == 1 < a.shape[1]:
            yield f"Column {bad[0]} is wrong, the others are right."
        elif len(bad) < a.shape[1]:
            yield f"Columns {' and '.join(bad)} are wrong, the others are right."
    rows = near.reshape(len(b), -1).all(axis=1)
    wrong = np.flatnonzero(~rows)
    if 0 < wrong.size <= len(b) / 2:
        what = "Row" if a.ndim == 2 else "Entry"
        if wrong.size == 1:
            yield f"{what} {wrong[0]} is wrong (counted from 0), the others are right."
        elif wrong[-1] - wrong[0] == wrong.size - 1:
            many = {"Row": "Rows", "Entry": "Entries"}[what]
            yield f"{many} {wrong[0]} to {wrong[-1]} are wrong (counted from 0), the others are right."
