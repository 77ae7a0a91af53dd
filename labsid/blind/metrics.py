"""One case judged, one bar of the table, and what counts as right."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import sqrt
from typing import Any

Z95 = 1.959963984540054


@dataclass(frozen=True, slots=True)
class CaseOutcome:
    """One case: what was in it, and what the diagnosis said.

    Attributes
    ----------
    label : dict
        As `labsid.blind.suite.label_dict` gives it.
    result : dict or None
        The diagnosis; None where there is none, which counts as wrong.
    diagnosed, possible : float or None
        Share of the gap closed by the diagnosis and by the true structure refitted.
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
    """One bar of the table.

    Attributes
    ----------
    name : str
    value : float or None
        None where there is nothing behind it.
    count : int
        Records behind it.
    low, high : float or None
        95 % interval: Wilson's where the figure is a rate.
    required, target : float or tuple of float or None
        The bar; a tuple is a range to lie in.
    below : bool
        Whether less is better.
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
        """Whether the value is as good as a bar; None where there is no value or no bar."""
        if requirement is None or self.value is None:
            return None
        if isinstance(requirement, tuple):
            return requirement[0] <= self.value <= requirement[1]
        return self.value <= requirement if self.below else self.value >= requirement

    def fails(self) -> bool:
        """Whether the bar that must be reached is missed by more than chance, as the interval tells it.

        Without an interval (a time, which depends on the machine) there is no telling.
        """
        if self.required is None or self.low is None or self.high is None or not self.count:
            return False
        least, most = self.required if isinstance(self.required, tuple) else (self.required, self.required)
        too_low, too_high = self.high < least, self.low > most
        if isinstance(self.required, tuple):
            return too_low or too_high
        return too_high if self.below else too_low


@dataclass(frozen=True, slots=True)
class Scores:
    """Everything the check found out.

    Attributes
    ----------
    metrics : tuple of Figure
    confusion : dict
        By row, then by true label, how often each set of names was given.
    calibration : tuple of (float, float, int)
        Mean probability, share right, and count of each bin.
    """

    metrics: tuple[Metric, ...]
    confusion: dict[str, dict[str, dict[str, int]]] = field(default_factory=dict)
    calibration: tuple[tuple[float, float, int], ...] = ()


def wilson(successes: int, count: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a rate.

    Parameters
    ----------
    successes, count : int

    Returns
    -------
    tuple of float
        (0, 1) where nothing was counted.
    """
    if count == 0:
        return 0.0, 1.0
    share, z2 = successes / count, Z95**2
    middle = (share + z2 / (2 * count)) / (1 + z2 / count)
    half = Z95 / (1 + z2 / count) * sqrt(share * (1 - share) / count + z2 / (4 * count**2))
    return max(0.0, middle - half), min(1.0, middle + half)


def named_effects(case: CaseOutcome) -> list[str]:
    """The effects that were named, in their order; empty where there is no result."""
    if case.result is None or stated_verdict(case) != "effect":
        return []
    return [str(effect.get("name")) for effect in case.result.get("effects") or []]


def stated_verdict(case: CaseOutcome) -> str:
    """The verdict; ``error`` where there is no result."""
    return "error" if case.result is None else str(case.result.get("verdict"))


def all_named(case: CaseOutcome) -> bool:
    """Whether all effects were named and nothing else."""
    return sorted(named_effects(case)) == sorted(case.label["labels"])


def any_named(case: CaseOutcome) -> bool:
    """Whether at least one of the effects was named."""
    return bool(set(named_effects(case)) & set(case.label["labels"]))


def answer_set(case: CaseOutcome) -> set[str]:
    """The names given and those said to be as likely."""
    ambiguous = (case.result or {}).get("ambiguous") or []
    return {*named_effects(case), *map(str, ambiguous)}


def within_answer_set(case: CaseOutcome) -> bool:
    """Whether the effect is in a set of at most three names."""
    said = answer_set(case)
    return len(said) <= 3 and set(case.label["labels"]) <= said


def never_confidently_wrong(case: CaseOutcome) -> bool:
    """Whether no wrong name was given with a probability above 0.9; without a result it was not answered."""
    if case.result is None:
        return False
    effects = case.result.get("effects") or []
    wrong = [e for e in effects if e.get("name") not in case.label["labels"]]
    return all(float(e.get("probability") or 0.0) <= 0.9 for e in wrong)


def kind_recognised(case: CaseOutcome) -> bool:
    """Whether none, wrong numbers and a structural effect were told apart."""

    def kind(effects: Iterable[str]) -> str:
        effects = set(effects)
        if not effects:
            return "none"
        return "parameters" if effects == {"parameter-mismatch"} else "structure"

    if stated_verdict(case) not in ("none", "effect"):
        return False
    said, true = kind(named_effects(case)), kind(case.label["labels"])
    return said == true and (true != "structure" or set(case.label["labels"]) <= set(named_effects(case)))
