"""Outcome of a case, metrics with their requirements, and the criteria for a correct answer."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import sqrt
from typing import Any

from labsid.rig.switchable.unlisted import UNLISTED_PATHS

Z95 = 1.959963984540054


@dataclass(frozen=True, slots=True)
class CaseOutcome:
    """Label of a case and answer of the diagnosis.

    Attributes
    ----------
    label : dict
        From `labsid.blind.suite.label_dict`.
    result : dict or None
        The diagnosis; None if there is none, which counts as wrong.
    diagnosed, possible : float or None
        Share of the gap closed by the diagnosis and by the refitted true structure.
    fresh_closure : float or None
        Closure of the same fit on fresh records.
    """

    label: dict[str, Any]
    result: dict[str, Any] | None
    diagnosed: float | None = None
    possible: float | None = None
    fresh_closure: float | None = None


@dataclass(frozen=True, slots=True)
class Metric:
    """One metric of the table with its requirement.

    Attributes
    ----------
    name : str
    value : float or None
        None if no record contributes.
    count : int
        Number of records that contribute.
    low, high : float or None
        95 % interval; Wilson's for a rate.
    required, target : float or tuple of float or None
        Required and desired value; a tuple is a range.
    below : bool
        Whether smaller is better.
    unit : str
        ``%`` for rates.
    """

    name: str
    value: float | None
    count: int
    low: float | None = None
    high: float | None = None
    required: float | tuple[float, float] | None = None
    target: float | tuple[float, float] | None = None
    below: bool = False
    unit: str = "%"

    def reaches(self, requirement: float | tuple[float, float] | None) -> bool | None:
        """Whether the value meets a requirement; None if there is no value or no requirement."""
        if requirement is None or self.value is None:
            return None
        if isinstance(requirement, tuple):
            return requirement[0] <= self.value <= requirement[1]
        return self.value <= requirement if self.below else self.value >= requirement

    def fails(self) -> bool:
        """Whether the 95 % interval lies wholly outside the required range.

        False for a metric without an interval, such as a time, which depends on the machine.
        """
        if self.required is None or self.low is None or self.high is None or not self.count:
            return False
        least, most = self.required if isinstance(self.required, tuple) else (self.required, self.required)
        too_low, too_high = self.high < least, self.low > most
        if isinstance(self.required, tuple):
            return too_low or too_high
        return too_high if self.below else too_low


@dataclass(frozen=True, slots=True)
class KindCounts:
    """Outcomes of one kind of ordinary records, or of all.

    Attributes
    ----------
    kind : str
    count : int
        Number of records.
    right : int
        Records with an accepted answer.
    wrong_likely, wrong_sure : int
        Records with a wrong name above 0.5 and above 0.9.
    no_report : int
        Records that end in an error or without a report.
    """

    kind: str
    count: int
    right: int
    wrong_likely: int
    wrong_sure: int
    no_report: int


@dataclass(frozen=True, slots=True)
class Scores:
    """Results of the sealed check.

    Attributes
    ----------
    metrics : tuple of Metric
    confusion : dict
        Counts of the answers by row and true label.
    calibration : tuple of (float, float, int)
        Mean probability, share of correct answers and count of each bin.
    kinds : tuple of KindCounts
        Of the row `honest`.
    """

    metrics: tuple[Metric, ...]
    confusion: dict[str, dict[str, dict[str, int]]] = field(default_factory=dict)
    calibration: tuple[tuple[float, float, int], ...] = ()
    kinds: tuple[KindCounts, ...] = ()


def wilson(successes: int, count: int) -> tuple[float, float]:
    """Wilson's 95 % interval for a rate.

    Parameters
    ----------
    successes, count : int

    Returns
    -------
    tuple of float
        (0, 1) if `count` is 0.
    """
    if count == 0:
        return 0.0, 1.0
    share, z2 = successes / count, Z95**2
    middle = (share + z2 / (2 * count)) / (1 + z2 / count)
    half = Z95 / (1 + z2 / count) * sqrt(share * (1 - share) / count + z2 / (4 * count**2))
    return max(0.0, middle - half), min(1.0, middle + half)


def rate(
    name: str,
    outcomes: Iterable[bool],
    required: float | tuple[float, float] | None = None,
    target: float | tuple[float, float] | None = None,
    below: bool = False,
) -> Metric:
    """Share of the outcomes that are true, as a metric with Wilson's interval.

    Parameters
    ----------
    name : str
    outcomes : iterable of bool
    required, target : float or tuple of float, optional
    below : bool
        Whether smaller is better.

    Returns
    -------
    Metric
    """
    counted = [bool(outcome) for outcome in outcomes]
    right, n = sum(counted), len(counted)
    low, high = wilson(right, n)
    return Metric(name, right / n if n else None, n, low, high, required, target, below)


def named_effects(case: CaseOutcome) -> list[str]:
    """Names of the stated effects in order; empty if there is no result."""
    if case.result is None or stated_verdict(case) not in ("effect", "partial"):
        return []
    return [str(effect.get("name")) for effect in case.result.get("effects") or []]


def asserted_effects(case: CaseOutcome, above: float) -> list[str]:
    """Names of the effects with a probability above `above`, in order."""
    effects = (case.result or {}).get("effects") or []
    return [str(effect.get("name")) for effect in effects if float(effect.get("probability") or 0.0) > above]


def stated_verdict(case: CaseOutcome) -> str:
    """The stated verdict; ``error`` if there is no result."""
    return "error" if case.result is None else str(case.result.get("verdict"))


def all_named(case: CaseOutcome) -> bool:
    """Whether exactly the true effects were named."""
    return sorted(named_effects(case)) == sorted(case.label["labels"])


def any_named(case: CaseOutcome) -> bool:
    """Whether at least one true effect was named."""
    return bool(set(named_effects(case)) & set(case.label["labels"]))


def answer_set(case: CaseOutcome) -> set[str]:
    """The named effects and those stated to be equally likely."""
    ambiguous = (case.result or {}).get("ambiguous") or []
    return {*named_effects(case), *map(str, ambiguous)}


def within_answer_set(case: CaseOutcome) -> bool:
    """Whether the answer set contains the true effects and at most three names."""
    said = answer_set(case)
    return len(said) <= 3 and set(case.label["labels"]) <= said


def never_confidently_wrong(case: CaseOutcome) -> bool:
    """Whether there is a result and it names no wrong effect with a probability above 0.9."""
    return case.result is not None and set(asserted_effects(case, 0.9)) <= set(case.label["labels"])


def nothing_asserted(case: CaseOutcome) -> bool:
    """Whether the verdict is unknown, or partial with no probability above 0.5."""
    return stated_verdict(case) in ("unknown", "partial") and not asserted_effects(case, 0.5)


def path_recognised(case: CaseOutcome) -> bool:
    """Whether the path of what is unexplained is the true one."""
    left = (case.result or {}).get("unexplained") or {}
    return left.get("path") in UNLISTED_PATHS[case.label["truth"]["kind"]]


def right_part_named(case: CaseOutcome) -> bool:
    """Whether the listed effect is named with a probability above 0.5, and no other effect is."""
    return asserted_effects(case, 0.5) == case.label["labels"]


def kind_recognised(case: CaseOutcome) -> bool:
    """Whether the kind of discrepancy (none, wrong parameters or a structural effect) was recognised."""

    def kind(effects: Iterable[str]) -> str:
        effects = set(effects)
        if not effects:
            return "none"
        return "parameters" if effects == {"parameter-mismatch"} else "structure"

    if stated_verdict(case) not in ("none", "effect", "partial"):
        return False
    said, true = kind(named_effects(case)), kind(case.label["labels"])
    return said == true and (true != "structure" or set(case.label["labels"]) <= set(named_effects(case)))
