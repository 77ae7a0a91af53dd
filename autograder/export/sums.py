"""Sums of the marks of several assignments, by their weights, for the systems that take them."""

from collections.abc import Mapping, Sequence
from decimal import ROUND_HALF_UP, Decimal

from autograder.results import grades
from autograder.results.grades import Totals
from autograder.results.result_files import StoredResult

CENT = Decimal("0.01")


def rounded(value: Decimal) -> Decimal:
    """Marks in cents."""
    return value.quantize(CENT, ROUND_HALF_UP)


def factors_of(stored: Sequence[StoredResult], weights: Mapping[str, Decimal]) -> dict[str, tuple[Decimal, Decimal]]:
    """All marks of each assignment in its notebook, and their factor in the sum; one alone has no weight."""
    most: dict[str, Decimal] = {}
    for one in stored:
        most[one.assignment] = max(grades.totals(one, {}).max_score, most.get(one.assignment, Decimal(0)))
    if len(most) == 1:
        return {name: (marks, Decimal(1)) for name, marks in most.items()}
    return {name: (marks, weights.get(name, marks) / marks if marks else Decimal(1)) for name, marks in most.items()}


def sum_totals(totals: Sequence[tuple[Totals, Decimal]]) -> Totals:
    """The sum of marks, each multiplied by its factor; rounded to cents if a factor is not 1."""
    parts = ([marks * factor for marks in (t.score, t.max_score, t.waiting, t.penalty)] for t, factor in totals)
    summed = [sum(column, Decimal(0)) for column in zip(*parts, strict=True)]
    exact = all(factor == 1 for _, factor in totals)
    return Totals(*(summed if exact else map(rounded, summed)))
