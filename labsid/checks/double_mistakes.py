"""Two known mistakes at once: formulas with two of their parts changed, and sums of terms with other factors."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.verdict import Answer, Slip, Verdict, are_named

TWO = "two mistakes at once"
"""The slip of an answer in which two parts of a formula are changed."""
FACTORS = "factors of the terms"
"""The slip of a sum whose terms have other factors."""
_SAME = 1e-9
_EXACT = 1e-9


@dataclass(frozen=True, slots=True)
class Edit:
    """A known mistake as a change of one part of a formula.

    Attributes
    ----------
    part : str
        The argument of the formula that is changed.
    value : object
        What it is changed to.
    says : str
        The mistake as a clause, to stand beside another: "sigma is not squared".
    """

    part: str
    value: Any
    says: str


def pairs_of(name: str, edits: Iterable[Edit], make: Callable[..., Answer]) -> Iterator[Slip[Answer]]:
    """The values that two mistakes give together, each pair named by both.

    Two pairs with the same value cannot be told apart, and are left out.

    Parameters
    ----------
    name : str
        What the sentence begins with, such as the function in back-ticks.
    edits : iterable of Edit
    make : callable
        ``make(**parts)`` is the formula with these parts changed.
    """
    if not are_named():
        return
    made: list[tuple[Edit, Edit, Any]] = []
    for one, other in combinations(list(edits), 2):
        if one.part != other.part:
            try:
                with np.errstate(all="ignore"):
                    value = make(**{one.part: one.value, other.part: other.value})
            except (ValueError, LookupError, ArithmeticError):
                continue
            if not np.iscomplexobj(np.asarray(value)):
                made.append((one, other, value))
    alone = _found_once([np.ravel(np.asarray(value, float)) for _, _, value in made])
    for (one, other, value), is_alone in zip(made, alone, strict=True):
        if is_alone:
            yield Slip(TWO, f"{name} has two mistakes: {one.says}; {other.says}.", partial(_itself, value))


def with_pairs(
    verdict: Verdict, got: Answer, same: Callable[[Answer, Answer], bool], pairs: Iterable[Slip[Answer]]
) -> Verdict:
    """A verdict that names no mistake, with the two mistakes that give the answer, if any of the pairs do."""
    if verdict.passed or verdict.slip is not None:
        return verdict
    for pair in pairs:
        if same(got, pair.wrong()):
            return replace(verdict, reason=pair.hint, slip=pair.name)
    return verdict


def told_factors(name: str, got: FloatArray, terms: Mapping[str, FloatArray], asked: Mapping[str, float]) -> str:
    """Of which multiples of known terms a result is the sum, where these are not the ones that are asked for.

    Parameters
    ----------
    name : str
        What the sentence begins with.
    got : ndarray
        At least one entry more than there are terms.
    terms : mapping
        Terms by how they are written, each of the shape of `got`.
    asked : mapping
        The right factors; 0 of a term that is not named.

    Returns
    -------
    str
        Empty if it is no such sum, or the right one.
    """
    columns = np.column_stack([np.ravel(term) for term in terms.values()])
    if np.size(got) <= columns.shape[1] or not np.all(np.isfinite(got)):
        return ""
    factors, _, rank, _ = np.linalg.lstsq(columns, np.ravel(got), rcond=None)
    size = float(np.max(np.abs(got), initial=0.0))
    if rank < columns.shape[1] or np.max(np.abs(columns @ factors - np.ravel(got))) > _EXACT * size:
        return ""
    found = {term: float(np.round(factor, 9)) for term, factor in zip(terms, factors, strict=True)}
    if all(abs(found[term] - asked.get(term, 0.0)) <= _SAME for term in found):
        return ""
    return f"{name} is {_sum_of(found)}; asked for is {_sum_of(asked)}."


def with_factors(
    verdict: Verdict, name: str, got: FloatArray, terms: Mapping[str, FloatArray], asked: Mapping[str, float]
) -> Verdict:
    """A verdict that names no mistake, with what `told_factors` says where that is anything."""
    if verdict.passed or verdict.slip is not None:
        return verdict
    said = told_factors(name, got, terms, asked)
    return replace(verdict, reason=said, slip=FACTORS) if said else verdict


def _sum_of(factors: Mapping[str, float]) -> str:
    written = ""
    for term, factor in factors.items():
        if factor:
            size = "" if abs(factor) == 1 else f"{abs(factor):.4g} "
            written += f" {'-' if factor < 0 else '+'} {size}{term}"
    return written.removeprefix(" + ").replace(" - ", "-", 1) if written.startswith(" -") else written[3:] or "zero"


def _itself(value: Answer) -> Answer:
    return value


def _found_once(values: list[FloatArray]) -> list[bool]:
    """Of each of these arrays, all of one size, whether it is finite and no other one is equal to it."""
    if not values:
        return []
    table = np.array(values)
    finite = np.all(np.isfinite(table), axis=1)
    table = np.where(np.isfinite(table), table, 0.0)
    distance = np.max(np.abs(table[:, np.newaxis] - table), axis=2)
    size = np.max(np.abs(table), axis=1)
    same = distance <= _SAME * np.maximum(size[:, np.newaxis], size)
    return [bool(one) for one in finite & (np.sum(same, axis=1) == 1)]
