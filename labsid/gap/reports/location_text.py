"""Sentences on the location of the gap in time, frequency and operating range."""

from itertools import groupby
from typing import Any

from labsid._texts import joined
from labsid.gap.reports.location import share_by_record, unevenness
from labsid.gap.reports.quantities import between, number, percent
from labsid.plots.signal_names import name_of

HALF = 0.5  # of the gap, that a reported band or range contains
DENSE_RATIO = 1.5  # error power over the average of the record, in a dense stretch
MIN_DENSE_SHARE = 0.4  # of the gap, that dense stretches must contain to be reported
MIN_EXCESS = 0.1  # share of the gap less share of the time, to report ranges
MIN_PART = 0.25  # of that excess, for one of several ranges
MAX_RANGES = 2


def location_sentences(report: dict[str, Any]) -> list[str]:
    """Sentences on where the gap lies in time, frequency and operating range."""
    where = report["where"]
    records = report.get("records")
    in_time = _in_records(report) if records else _in_time(where["time"])
    texts = [in_time, _in_frequency(where["band_hz"]), *_in_range(report)]
    if "only_on_holdout" in report:
        texts = [text.replace(" record", " holdout") for text in texts]
    return [text for text in texts if text]


def _in_records(report: dict[str, Any]) -> str:
    """In which of several records most of the gap lies."""
    shares = share_by_record(report["where"]["time"], report["records"], report["record"]["Ts"])
    worst = max(shares, key=lambda one: one["share"])
    if worst["share"] - worst["time"] < MIN_EXCESS:
        return "The gap is spread over all records."
    return f"{percent(worst['share'])} of the gap lies in {worst['name']}, {percent(worst['time'])} of the samples."


def _in_time(segments: list[list[float]]) -> str:
    if not segments:
        return ""
    whole = segments[-1][1] - segments[0][0]
    dense: list[list[float]] = []  # [start, stop, share], adjacent segments merged
    for start, stop, share in segments:
        if share * whole <= DENSE_RATIO * (stop - start):
            continue
        if dense and start - dense[-1][1] < 1e-6 * whole:
            dense[-1] = [dense[-1][0], stop, dense[-1][2] + share]
        else:
            dense.append([start, stop, share])
    total, time = sum(s[2] for s in dense), sum(s[1] - s[0] for s in dense) / whole
    if total < MIN_DENSE_SHARE:
        return "The gap is spread over the whole record."
    low, high = between(*max(dense, key=lambda s: s[2])[:2])
    if len(dense) == 1:
        return f"{percent(total)} of the gap lies between {low} and {high} s, {percent(time)} of the record."
    return (
        f"{percent(total)} of the gap lies in {len(dense)} stretches that make up {percent(time)} of the record; "
        f"the largest is {low} to {high} s."
    )


def _in_frequency(bands: list[list[float]]) -> str:
    run = _narrowest_half([band[2] for band in bands])
    if run is None:
        return ""
    low, high = bands[run[0]][0], bands[run[1] - 1][1]
    share = percent(sum(band[2] for band in bands[run[0] : run[1]]))
    if low == 0.0:
        return f"{share} of it lies below {number(high)} Hz."
    return f"{share} of it lies between {number(low)} and {number(high)} Hz."


def _in_range(report: dict[str, Any]) -> list[str]:
    texts = []
    cells: dict[str, list[dict[str, Any]]] = {}
    for cell in report["where"]["operating"]:
        cells.setdefault(cell["signal"], []).append(cell)
    for signal, own in cells.items():
        what = f"the rate of {name_of(report, 'y')}" if signal == "dy" else name_of(report, signal)
        if unevenness(own) < MIN_EXCESS:
            texts.append(f"Over the range of {what}, the gap is in proportion to the time spent at each value.")
            continue
        inside = _dense_runs(own)
        share, time = (sum(cell[name] for run in inside for cell in run) for name in ("share", "time"))
        ends = (between(run[0]["low"], run[-1]["high"]) for run in inside)
        places = joined([f"between {low} and {high}" for low, high in ends], "or")
        texts.append(
            f"{percent(share)} of it lies where {what} is {places}, in which the record spends {percent(time)} of its "
            "time."
        )
    return texts


def _dense_runs(cells: list[dict[str, Any]]) -> list[list[dict[str, Any]]]:
    """Runs of adjacent cells that hold more of the gap than of the time, in their order; small ones are left out."""
    runs = [list(run) for dense, run in groupby(cells, lambda cell: cell["share"] > cell["time"]) if dense]
    excess = [sum(cell["share"] - cell["time"] for cell in run) for run in runs]
    largest = sorted(range(len(runs)), key=lambda i: -excess[i])[:MAX_RANGES]
    return [runs[i] for i in sorted(largest) if excess[i] >= MIN_PART * sum(excess)]


def _narrowest_half(shares: list[float]) -> tuple[int, int] | None:
    """The shortest run of cells that contains half of the total, as a half-open range; the largest such run."""
    for width in range(1, len(shares)):
        starts = range(len(shares) - width + 1)
        best = max(starts, key=lambda i: sum(shares[i : i + width]))
        if sum(shares[best : best + width]) >= HALF:
            return best, best + width
    return None
