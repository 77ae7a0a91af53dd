"""The row `several`: two or three effects of the table and a small one outside it."""

from collections.abc import Iterable, Sequence

import numpy as np

from labsid.blind.metrics import CaseOutcome, Metric, asserted_effects, rate

LIKELY = 0.5
"""Probability above which a name is asserted."""

PLACES = ("first", "second", "third")
BINS = 5


def names_only_true(case: CaseOutcome) -> bool:
    """Whether there is a result in which every name above 0.5 is an effect of the rig."""
    return case.result is not None and set(asserted_effects(case, LIKELY)) <= set(case.label["labels"])


def several_metrics(cases: Sequence[CaseOutcome], partial: Sequence[CaseOutcome]) -> list[Metric]:
    """Metrics of the row, and how well the probabilities of first, second and third names are calibrated.

    Parameters
    ----------
    cases, partial : sequence of CaseOutcome
        Of the rows `several` and `partial`.
    """
    named = [name in asserted_effects(case, LIKELY) for case in cases for name in case.label["labels"]]
    both = [*cases, *partial]
    return [
        rate("several effects: every name above 0.5 is right", map(names_only_true, cases), 0.90, 0.97),
        rate("several effects: share of them named above 0.5", named, 0.60, 0.80),
        *(_calibration(f"  calibration of {place} names (ECE)", _said(both, n)) for n, place in enumerate(PLACES)),
    ]


def _said(cases: Iterable[CaseOutcome], place: int) -> list[tuple[float, bool]]:
    """Probability of the name at a place of each answer, by falling probability, and whether it is right."""
    found = []
    for case in cases:
        effects = sorted(
            (case.result or {}).get("effects") or [], key=lambda one: -float(one.get("probability") or 0.0)
        )
        for one in effects[place : place + 1]:
            found.append((float(one.get("probability") or 0.0), one.get("name") in case.label["labels"]))
    return found


def _calibration(name: str, said: Sequence[tuple[float, bool]]) -> Metric:
    """Expected calibration error over bins of equal width."""
    if not said:
        return Metric(name, None, 0, required=0.05, target=0.03, below=True, unit="")
    p, right = np.array(said, dtype=float).T
    places = np.minimum((p * BINS).astype(int), BINS - 1)
    error = sum(abs(float(np.sum((p - right)[places == i]))) for i in range(BINS)) / p.size
    return Metric(name, float(error), p.size, required=0.05, target=0.03, below=True, unit="")
