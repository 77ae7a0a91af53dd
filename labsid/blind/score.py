"""Metrics of the sealed check, computed from results and labels."""

from collections.abc import Sequence
from dataclasses import replace
from math import sqrt
from typing import Any

import numpy as np

from labsid.blind.honest import count_kinds, honest_metrics
from labsid.blind.joints import joint_metrics
from labsid.blind.metrics import (
    Z95,
    CaseOutcome,
    Metric,
    Scores,
    all_named,
    answer_set,
    any_named,
    kind_recognised,
    named_effects,
    never_confidently_wrong,
    nothing_asserted,
    path_recognised,
    rate,
    right_part_named,
    stated_verdict,
    within_answer_set,
)
from labsid.blind.placed_effects import SIGNAL_ROWS, signal_metrics
from labsid.blind.several import several_metrics

ALONE = "run-alone"
"""Row of the first runs of the row `runs`, diagnosed without the others, in the same order."""


def score_cases(
    cases: Sequence[CaseOutcome], replays: Sequence[CaseOutcome] = (), seconds: float | None = None
) -> Scores:
    """Compute the metrics, the confusion table and the calibration of all cases.

    Parameters
    ----------
    cases : sequence of CaseOutcome
    replays : sequence of CaseOutcome
        Cases whose exported simulation was run on fresh records.
    seconds : float, optional
        Time per record and core (s).

    Returns
    -------
    Scores
    """
    rows: dict[str, list[CaseOutcome]] = {}
    for case in cases:
        rows.setdefault(case.label["row"], []).append(case)
    empty: list[CaseOutcome] = []
    clear, hard, short = (rows.get(name, empty) for name in ("single-clear", "single-hard", "short"))
    families, variants = rows.get("families", empty), rows.get("variants", empty)
    pair, none, unknown = (rows.get(name, empty) for name in ("pair", "none", "unknown"))
    together, alone = ([all_named(case) for case in rows.get(name, empty)] for name in ("runs", ALONE))
    honest, faint = rows.get("honest", empty), rows.get("faint", empty)
    rigs = [case for case in cases if case.label["row"] not in ("honest", "faint", *SIGNAL_ROWS)]
    bins = calibration_bins(rigs)
    metrics = [
        rate("right effect named, one effect, clear", map(all_named, clear), 0.98, 0.995),
        rate("right effect named, one effect, hard", map(all_named, hard), 0.95, 0.98),
        rate("short and noisy: named", map(all_named, short), 0.88, 0.92),
        rate("short and noisy: within the named or ambiguous set", map(within_answer_set, short), 0.95, 0.98),
        _set_size("short and noisy: names in that set, mean", short, 1.4),
        rate("pair: exactly both named", map(all_named, pair), 0.90, 0.95),
        rate("pair: at least one named", map(any_named, pair), 0.98, 0.995),
        rate("no effect: none reported", (stated_verdict(c) == "none" for c in none), 0.99, 0.995),
        rate("outside the table: unknown, or partial with p <= 0.5", map(nothing_asserted, unknown), 0.88, 0.95),
        rate("outside the table: path of the unexplained error", map(path_recognised, unknown), 0.75, 0.90),
        rate("outside the table: never p > 0.9 for a wrong name", map(never_confidently_wrong, unknown), 0.98, 0.995),
        rate(
            "beside an effect outside the table: the listed effect, and no other, with p > 0.5",
            map(right_part_named, rows.get("partial", empty)),
            0.75,
            0.90,
        ),
        rate("end stop, drag, slow mode, play at the output: named, clear", map(all_named, families), 0.93, 0.98),
        rate("other forms of friction, dead zone and sensor curve: named", map(all_named, variants)),
        rate("three short, noisy runs of one rig: named", together),
        rate("the first of them alone: named", alone),
        _gain("three runs of one rig more often than one, percentage points", together, alone, 0.05, 0.08),
        *_closure_metrics(clear),
        replace(_closure_metrics(families)[0], name="end stop, drag, slow mode, play: the same share, median"),
        rate("95 % interval of the closed share covers fresh records", _covered(replays), (0.93, 0.97), (0.94, 0.96)),
        _calibration_error(bins),
        rate("load-step onset within 2 % of the record", _onsets(rigs), 0.97, 0.995),
        rate("clip levels within 2 % of the range", _clip_levels(rigs), 0.97, 0.995),
        rate(
            "with a simulation: kind of discrepancy recognised",
            map(kind_recognised, rows.get("with-sim", empty)),
            0.97,
            0.99,
        ),
        *honest_metrics(honest, faint),
        *joint_metrics(rows.get("joints", empty)),
        *several_metrics(rows.get("several", empty), rows.get("partial", empty)),
        *signal_metrics(*(rows.get(name, empty) for name in SIGNAL_ROWS)),
        Metric("time per record and core", seconds, len(cases), required=5.0, target=2.0, below=True, unit="s"),
    ]
    return Scores(tuple(metrics), confusion(cases), bins, count_kinds(honest))


def confusion(cases: Sequence[CaseOutcome]) -> dict[str, dict[str, dict[str, int]]]:
    """Count answers by row and true label.

    Parameters
    ----------
    cases : sequence of CaseOutcome

    Returns
    -------
    dict
        ``{row: {label: {answer: count}}}``; the label of a pair is ``a+b`` in alphabetical order.
    """
    table: dict[str, dict[str, dict[str, int]]] = {}
    for case in cases:
        true = "+".join(sorted(case.label["labels"])) or "none"
        said = "+".join(sorted(named_effects(case))) or stated_verdict(case)
        counts = table.setdefault(case.label["row"], {}).setdefault(true, {})
        counts[said] = counts.get(said, 0) + 1
    return table


def calibration_bins(cases: Sequence[CaseOutcome], bins: int = 10) -> tuple[tuple[float, float, int], ...]:
    """Compare the stated probabilities with the share of correct answers.

    Parameters
    ----------
    cases : sequence of CaseOutcome
    bins : int
        Number of bins of equal width.

    Returns
    -------
    tuple of (float, float, int)
        Mean probability, share of correct answers and count of each non-empty bin. The first effect of every answer
        counts.
    """
    said = [
        (float(effect.get("probability") or 0.0), effect.get("name") in case.label["labels"])
        for case in cases
        for effect in ((case.result or {}).get("effects") or [])[:1]
    ]
    places = [min(int(p * bins), bins - 1) for p, _ in said]
    filled = []
    for i in range(bins):
        inside = [pair for pair, place in zip(said, places, strict=True) if place == i]
        if inside:
            p, right = np.mean(np.array(inside, dtype=float), axis=0)
            filled.append((float(p), float(right), len(inside)))
    return tuple(filled)


def _gain(name: str, after: Sequence[bool], before: Sequence[bool], required: float, target: float) -> Metric:
    """Difference of two rates over the same cases, with the interval of paired differences."""
    gains = np.subtract(after, before, dtype=float)
    if not gains.size:
        return Metric(name, None, 0, required=required, target=target)
    value, half = float(gains.mean()), Z95 * float(gains.std()) / sqrt(gains.size)
    return Metric(name, value, gains.size, value - half, value + half, required, target)


def _set_size(name: str, cases: Sequence[CaseOutcome], requirement: float) -> Metric:
    sizes = [len(answer_set(case)) for case in cases if answer_set(case)]
    value = float(np.mean(sizes)) if sizes else None
    return Metric(name, value, len(sizes), required=requirement, below=True, unit="")


def _closure_metrics(cases: Sequence[CaseOutcome]) -> list[Metric]:
    counted = [c for c in cases if c.possible is not None and c.possible > 0.2]
    shares = [max(c.diagnosed or 0.0, 0.0) / c.possible for c in counted if c.possible]
    title = "median share of the gap closed, relative to the refitted true structure"
    median = float(np.median(shares)) if shares else None
    low, high = _median_interval(shares)
    plain = float(np.median([c.diagnosed or 0.0 for c in counted])) if counted else None
    truth = float(np.median([c.possible for c in counted if c.possible])) if counted else None
    return [
        Metric(title, median, len(shares), low, high, 0.98, 1.0, unit=""),
        Metric("  share closed by the diagnosis, median", plain, len(counted), unit=""),
        Metric("  share closed by the true structure, median", truth, len(counted), unit=""),
    ]


def _median_interval(values: Sequence[float]) -> tuple[float | None, float | None]:
    """95 % interval of the median from order statistics."""
    n = len(values)
    if n < 6:
        return None, None
    half = 0.5 * Z95 * sqrt(n)
    ordered = sorted(values)
    return ordered[max(int(n / 2 - half), 0)], ordered[min(int(np.ceil(n / 2 + half)), n - 1)]


def _covered(replays: Sequence[CaseOutcome]) -> list[bool]:
    outcomes = []
    for case in replays:
        interval = ((case.result or {}).get("gap") or {}).get("ci95")
        if case.fresh_closure is not None and interval and None not in interval:
            outcomes.append(interval[0] <= case.fresh_closure <= interval[1])
    return outcomes


def _calibration_error(bins: Sequence[tuple[float, float, int]]) -> Metric:
    count = sum(n for _, _, n in bins)
    error = sum(n * abs(p - right) for p, right, n in bins) / count if count else None
    return Metric("probability calibration (ECE)", error, count, required=0.03, target=0.02, below=True, unit="")


def _found_parameters(case: CaseOutcome, effect: str) -> dict[str, Any] | None:
    """Parameter values of an effect that is present with known parameters and was named."""
    for said in (case.result or {}).get("effects") or []:
        if effect == said.get("name") and effect in case.label["labels"] and effect in case.label["truth"]:
            given = said.get("parameters") or {}
            return {name: p.get("value") if isinstance(p, dict) else p for name, p in given.items()}
    return None


def _onsets(cases: Sequence[CaseOutcome]) -> list[bool]:
    outcomes = []
    for case in cases:
        found = _found_parameters(case, "load-step")
        if found is not None:
            label = case.label
            length = label["Ts"] * label["samples"]
            onset = found.get("onset")
            true = label["truth"]["load-step"]["onset"]
            outcomes.append(onset is not None and abs(onset - true) <= 0.02 * length)
    return outcomes


def _clip_levels(cases: Sequence[CaseOutcome]) -> list[bool]:
    outcomes = []
    for case in cases:
        for effect, signal in (("input-saturation", "u_range"), ("output-saturation", "y_range")):
            found = _found_parameters(case, effect)
            if found is None:
                continue
            for side, level in case.label["truth"][effect].items():
                value = found.get(side)
                outcomes.append(value is not None and abs(value - level) <= 0.02 * case.label[signal])
    return outcomes
