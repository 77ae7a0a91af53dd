"""The row `honest`: ordinary records, most of them without a gap, and the rates of what is invented there."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from labsid.blind.experiment import OrdinaryCase
from labsid.blind.metrics import CaseOutcome, KindCounts, Metric, asserted_effects, named_effects, rate, stated_verdict
from labsid.rig.ordinary.kinds import KINDS

NEAR = 0.05
"""Largest error of a free number, as a share of its true value."""

LIKELY, SURE = 0.5, 0.9
"""Probabilities above which a wrong name counts."""


def draw_honest(rng: np.random.Generator, i: int, name: str) -> OrdinaryCase | None:
    """An ordinary record; the kinds take turns."""
    kind = list(KINDS)[i % len(KINDS)]
    made = KINDS[kind](rng)
    return None if made is None else OrdinaryCase(name=name, row="honest", kind=kind, made=made)


def is_accepted(case: CaseOutcome) -> bool:
    """Whether the answer is one of those that are right.

    An explanation of all but noise asserts each of its effects; a partial one those above 0.5, and without such an
    effect it is the answer ``unknown``.
    """
    said = _said(case)
    return said is not None and sorted(said) in map(sorted, _answers(case))


def wrong_names(case: CaseOutcome, above: float) -> list[str]:
    """Names with a probability above `above` that are in no right answer."""
    true = {name for answer in _answers(case) for name in answer}
    return [name for name in asserted_effects(case, above) if name not in true]


def has_no_report(case: CaseOutcome) -> bool:
    """Whether the diagnosis ended in an error or without a result."""
    return stated_verdict(case) == "error"


def has_right_numbers(case: CaseOutcome) -> bool:
    """Whether each free number is near its true value, or has no standard error if the record does not determine it.

    True of a record without free numbers.
    """
    true, numbers = case.label.get("numbers"), found_numbers(case.result)
    if true is None:
        return True
    if not set(true["determined"]) | set(true["undetermined"]) <= set(numbers):
        return False
    near = [_is_near(numbers[name][0], value) for name, value in true["determined"].items()]
    near += [numbers[name][1] is None for name in true["undetermined"]]
    if true["combination"]:
        first, second = (numbers[name][0] for name in true["undetermined"])
        product = "*" in true["combination"]
        near.append(_is_near(first * second, true["value"]) if product else _is_near(first, true["value"] * second))
    return all(near)


def found_numbers(result: dict[str, Any] | None) -> dict[str, tuple[float, float | None]]:
    """Value and standard error of each free number; a list of them in later layouts, a dict in earlier ones.

    Parameters
    ----------
    result : dict or None
        A report; None if there is none.
    """
    listed = (result or {}).get("numbers")
    if listed is None:
        named = ((result or {}).get("simulation") or {}).get("numbers") or {}
        listed = [{"name": name, **number} for name, number in named.items()]
    return {
        number["name"]: (float(number["value"]), number["stderr"]) for number in listed if number["value"] is not None
    }


def count_kinds(cases: Sequence[CaseOutcome]) -> tuple[KindCounts, ...]:
    """Count the outcomes of the row by kind, and in all.

    Parameters
    ----------
    cases : sequence of CaseOutcome
        Of the row `honest`.

    Returns
    -------
    tuple of KindCounts
        The last one, ``all``, holds every record; empty without records.
    """
    kinds: dict[str, list[CaseOutcome]] = {}
    for case in cases:
        kinds.setdefault(case.label["truth"]["kind"], []).append(case)
    return tuple(_counted(kind, some) for kind, some in kinds.items()) + ((_counted("all", cases),) if cases else ())


def honest_metrics(honest: Sequence[CaseOutcome], faint: Sequence[CaseOutcome]) -> list[Metric]:
    """Metrics of the rows `honest` and `faint`.

    Parameters
    ----------
    honest, faint : sequence of CaseOutcome
    """
    numbers = [case for case in honest if case.label["numbers"] is not None]
    return [
        rate("ordinary records: right answer", map(is_accepted, honest), 0.95, 0.99),
        *_wrong_rates("ordinary records", honest, (0.02, 0.005), (0.005, 0.0)),
        rate("ordinary records: no report", map(has_no_report, honest), 0.0, 0.0, below=True),
        rate(
            "free numbers: within 5 % of the truth, undetermined ones without an error",
            map(has_right_numbers, numbers),
            0.95,
            0.99,
        ),
        *_wrong_rates("faint effect", faint, (0.02, 0.005), (0.005, 0.0)),
    ]


def _wrong_rates(
    what: str, cases: Sequence[CaseOutcome], likely: tuple[float, float], sure: tuple[float, float]
) -> list[Metric]:
    """Wrong names as shares of the records, with required and target rates, and of the claims above 0.9."""
    claims = [name not in wrong_names(case, SURE) for case in cases for name in asserted_effects(case, SURE)]
    return [
        rate(f"{what}: a wrong name above 0.5", (bool(wrong_names(c, LIKELY)) for c in cases), *likely, below=True),
        rate(f"{what}: a wrong name above 0.9", (bool(wrong_names(c, SURE)) for c in cases), *sure, below=True),
        rate(f"  {what}: wrong among the names above 0.9", (not right for right in claims), below=True),
    ]


def _counted(kind: str, cases: Sequence[CaseOutcome]) -> KindCounts:
    return KindCounts(
        kind,
        len(cases),
        sum(map(is_accepted, cases)),
        sum(bool(wrong_names(case, LIKELY)) for case in cases),
        sum(bool(wrong_names(case, SURE)) for case in cases),
        sum(map(has_no_report, cases)),
    )


def _said(case: CaseOutcome) -> list[str] | None:
    """The answer as one of `_answers`; None without a report."""
    match stated_verdict(case):
        case "none":
            return []
        case "effect":
            return named_effects(case) or None
        case "partial":
            return asserted_effects(case, LIKELY) or ["unknown"]
        case "unknown":
            return ["unknown"]
        case _:
            return None


def _answers(case: CaseOutcome) -> list[list[str]]:
    return list(case.label.get("answers") or [case.label["labels"]])


def _is_near(value: float, true: float) -> bool:
    return abs(value - true) <= NEAR * abs(true)
