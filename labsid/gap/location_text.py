"""Where the gap lies, in sentences: in time, in frequency, and over the operating range."""

from typing import Any

from labsid.gap.quantities import between, number, percent

HALF = 0.5  # of the gap: what a band or a range must hold to be named
DENSE_RATIO = 1.5  # times the average over the record
MIN_DENSE_SHARE = 0.4  # of the gap, that dense stretches must hold to be named
MIN_EXCESS = 0.1  # of the gap, above the share of the time


def location_sentences(report: dict[str, Any]) -> list[str]:
    """Where the gap lies in time, in frequency and over the operating range."""
    where = report["where"]
    said = [_in_time(where["time"]), _in_frequency(where["band_hz"]), *_in_range(report)]
    return [text for text in said if text]


def _in_time(segments: list[list[float]]) -> str:
    if not segments:
        return ""
    whole = segments[-1][1] - segments[0][0]
    dense: list[list[float]] = []  # stretches of [start, stop, share], neighbours as one
    for start, stop, share in segments:
        if share * whole <= DENSE_RATIO * (stop - start):
            continue
        if dense and start - dense[-1][1] < 1e-6 * whole:
            dense[-1] = [dense[-1][0], stop, dense[-1][2] + share]
        else:
            dense.append([start, stop, share])
    total, time = sum(s[2] for s in dense), sum(s[1] - s[0] for s in dense) / whole
    if total < MIN_DENSE_SHARE:
        return "In time it is spread over the whole record."
    low, high = between(*max(dense, key=lambda s: s[2])[:2])
    if len(dense) == 1:
        return f"In time, {percent(total)} of it lies between {low} and {high} s, {percent(time)} of the record."
    return (
        f"In time, {percent(total)} of it lies in {len(dense)} stretches that make up {percent(time)} of the record, "
        f"most between {low} and {high} s."
    )


def _in_frequency(bands: list[list[float]]) -> str:
    run = _narrowest_half([band[2] for band in bands])
    if run is None:
        return ""
    low, high = bands[run[0]][0], bands[run[1] - 1][1]
    share = percent(sum(band[2] for band in bands[run[0] : run[1]]))
    if low == 0.0:
        return f"In frequency, {share} of it lies below {number(high)} Hz."
    return f"In frequency, {share} of it lies between {number(low)} and {number(high)} Hz."


def _in_range(report: dict[str, Any]) -> list[str]:
    said = []
    cells: dict[str, list[dict[str, Any]]] = {}
    for cell in report["where"]["operating"]:
        cells.setdefault(cell["signal"], []).append(cell)
    for signal, own in cells.items():
        run = _narrowest_half([cell["share"] for cell in own])
        if run is None:
            continue
        inside = own[run[0] : run[1]]
        share, time = (sum(cell[name] for cell in inside) for name in ("share", "time"))
        what = "the change of y a second" if signal == "dy" else signal
        if share < time + MIN_EXCESS:
            said.append(f"In the operating range it follows the time that the record spends at each value of {what}.")
            continue
        low, high = between(inside[0]["low"], inside[-1]["high"])
        said.append(
            f"In the operating range, {percent(share)} of it lies where {what} is between {low} and {high}; "
            f"the record spends {percent(time)} of its time there."
        )
    return said


def _narrowest_half(shares: list[float]) -> tuple[int, int] | None:
    """The fewest neighbours that hold half of the whole, the fullest of those: first and one past the last."""
    for width in range(1, len(shares)):
        starts = range(len(shares) - width + 1)
        best = max(starts, key=lambda i: sum(shares[i : i + width]))
        if sum(shares[best : best + width]) >= HALF:
            return best, best + width
    return None
