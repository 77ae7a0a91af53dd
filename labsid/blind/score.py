"""From results and labels to figures: pure functions, nothing is run here."""

from collections.abc import Iterable, Sequence
from math import sqrt
from typing import Any

import numpy as np

from labsid.blind.metrics import (
    Z95,
    Figure,
    Judged,
    Scores,
    answer_set,
    exactly_named,
    inside_set,
    names,
    not_sure,
    one_named,
    told_apart,
    verdict,
    wilson,
)


def score(cases: Sequence[Judged], replays: Sequence[Judged] = (), seconds: float | None = None) -> Scores:
    """Judge all cases.

    Parameters
    ----------
    cases : sequence of Judged
    replays : sequence of Judged
        Those whose exported simulation was played on fresh records.
    seconds : float, optional
        Time a record and core.

    Returns
    -------
    Scores
    """
    rows: dict[str, list[Judged]] = {}
    for case in cases:
        rows.setdefault(case.label["row"], []).append(case)
    empty: list[Judged] = []
    clear, hard, short = (rows.get(name, empty) for name in ("single-clear", "single-hard", "short"))
    pair, none, unknown = (rows.get(name, empty) for name in ("pair", "none", "unknown"))
    bins = calibration_bins(cases)
    figures = [
        _rate("right effect named, one effect, clear", map(exactly_named, clear), 0.97, 0.995),
        _rate("right effect named, one effect, hard", map(exactly_named, hard), 0.93, 0.98),
        _rate("short and noisy: named", map(exactly_named, short), 0.75, 0.88),
        _rate("short and noisy: inside the named or ambiguous set", map(inside_set, short), 0.90, 0.97),
        _set_size("short and noisy: names in that set, mean", short, 1.5),
        _rate("pair: both and nothing else", map(exactly_named, pair), 0.80, 0.90),
        _rate("pair: at least one of them", map(one_named, pair), 0.97, 0.99),
        _rate("no effect: none reported", (verdict(c) == "none" for c in none), 0.98, 0.995),
        _rate("outside the table: unknown", (verdict(c) == "unknown" for c in unknown), 0.75, 0.90),
        _rate("outside the table: never p > 0.9 for a wrong name", map(not_sure, unknown), 0.95, 0.98),
        *_closure_figures(clear),
        _rate("95 % interval of closed covers fresh records", _covered(replays), (0.92, 0.98), (0.94, 0.96)),
        _calibration_error(bins),
        _rate("load-step onset within 2 % of the record", _onsets(cases), 0.95, 0.99),
        _rate("clip levels within 2 % of the range", _clip_levels(cases), 0.95, 0.99),
        _rate("with a simulation: told apart", map(told_apart, rows.get("with-sim", empty)), 0.90, 0.97),
        Figure("time a record and core", seconds, len(cases), must=5.0, aim=2.0, below=True, unit="s"),
    ]
    return Scores(tuple(figures), confusion(cases), bins)


def confusion(cases: Sequence[Judged]) -> dict[str, dict[str, dict[str, int]]]:
    """Count answers by row and true label.

    Parameters
    ----------
    cases : sequence of Judged

    Returns
    -------
    dict
        ``{row: {label: {answer: count}}}``; of a pair the label is ``a+b`` in alphabetical order.
    """
    table: dict[str, dict[str, dict[str, int]]] = {}
    for case in cases:
        true = "+".join(sorted(case.label["labels"])) or "none"
        said = "+".join(sorted(names(case))) or verdict(case)
        counts = table.setdefault(case.label["row"], {}).setdefault(true, {})
        counts[said] = counts.get(said, 0) + 1
    return table


def calibration_bins(cases: Sequence[Judged], bins: int = 10) -> tuple[tuple[float, float, int], ...]:
    """How often an effect named with some probability was there.

    Parameters
    ----------
    cases : sequence of Judged
    bins : int
        Equal ranges of the probability.

    Returns
    -------
    tuple of (float, float, int)
        Mean probability, share right, and count, of the bins that hold anything. The first effect of every
        answer counts, whatever the case.
    """
    said = [
        (float(effect.get("probability") or 0.0), effect.get("name") in case.label["labels"])
        for case in cases
        for effect in ((case.result or {}).get("effects") or [])[:1]
    ]
    places = [min(int(p * bins), bins - 1) for p, _ in said]
    found = []
    for i in range(bins):
        inside = [pair for pair, place in zip(said, places, strict=True) if place == i]
        if inside:
            p, right = np.mean(np.array(inside, dtype=float), axis=0)
            found.append((float(p), float(right), len(inside)))
    return tuple(found)


def _rate(
    name: str,
    outcomes: Iterable[bool],
    must: float | tuple[float, float],
    aim: float | tuple[float, float],
) -> Figure:
    counted = [bool(outcome) for outcome in outcomes]
    right, n = sum(counted), len(counted)
    low, high = wilson(right, n)
    return Figure(name, right / n if n else None, n, low, high, must, aim)


def _set_size(name: str, cases: Sequence[Judged], bar: float) -> Figure:
    sizes = [len(answer_set(case)) for case in cases if answer_set(case)]
    value = float(np.mean(sizes)) if sizes else None
    return Figure(name, value, len(sizes), must=bar, below=True, unit="")


def _closure_figures(cases: Sequence[Judged]) -> list[Figure]:
    counted = [c for c in cases if c.possible is not None and c.possible > 0.2]
    shares = [max(c.diagnosed or 0.0, 0.0) / c.possible for c in counted if c.possible]
    title = "median share of the gap closed, against the true structure refitted"
    median = float(np.median(shares)) if shares else None
    low, high = _median_interval(shares)
    plain = float(np.median([c.diagnosed or 0.0 for c in counted])) if counted else None
    truth = float(np.median([c.possible for c in counted if c.possible])) if counted else None
    return [
        Figure(title, median, len(shares), low, high, 0.95, 0.98, unit=""),
        Figure("  the share itself, median", plain, len(counted), unit=""),
        Figure("  that of the true structure, median", truth, len(counted), unit=""),
    ]


def _median_interval(values: Sequence[float]) -> tuple[float | None, float | None]:
    """Order statistics that hold the median with 95 %."""
    n = len(values)
    if n < 6:
        return None, None
    half = 0.5 * Z95 * sqrt(n)
    ordered = sorted(values)
    return ordered[max(int(n / 2 - half), 0)], ordered[min(int(np.ceil(n / 2 + half)), n - 1)]


def _covered(replays: Sequence[Judged]) -> list[bool]:
    outcomes = []
    for case in replays:
        interval = ((case.result or {}).get("gap") or {}).get("ci95")
        if case.fresh is not None and interval and None not in interval:
            outcomes.append(interval[0] <= case.fresh <= interval[1])
    return outcomes


def _calibration_error(bins: Sequence[tuple[float, float, int]]) -> Figure:
    count = sum(n for _, _, n in bins)
    error = sum(n * abs(p - right) for p, right, n in bins) / count if count else None
    return Figure("probability calibration (ECE)", error, count, must=0.05, aim=0.03, below=True, unit="")


def _found_parameters(case: Judged, effect: str) -> dict[str, Any] | None:
    """The parameters of an effect that is there and was named; their values alone."""
    for said in (case.result or {}).get("effects") or []:
        if effect == said.get("name") and effect in case.label["labels"]:
            given = said.get("parameters") or {}
            return {name: p.get("value") if isinstance(p, dict) else p for name, p in given.items()}
    return None


def _onsets(cases: Sequence[Judged]) -> list[bool]:
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


def _clip_levels(cases: Sequence[Judged]) -> list[bool]:
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
