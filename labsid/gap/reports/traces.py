"""Signals for the figures of a report, reduced to local extremes if the record is long."""

import base64
from typing import Any

import numpy as np

from labsid._arrays import FloatArray, lies_within, window_sums

MAX_POINTS = 2400  # samples of a figure
STRETCH, FEWEST, MOST = 0.1, 40, 400  # share of the record in the worst stretch, and its samples


def extreme_samples(signals: list[FloatArray], most: int = MAX_POINTS) -> np.ndarray:
    """Select the samples at which a signal has its minimum or maximum within each part of the record.

    Parameters
    ----------
    signals : list of ndarray, shape (N,)
    most : int
        Largest number of samples.

    Returns
    -------
    ndarray of int
        Increasing; all samples if there are at most `most`.
    """
    samples = signals[0].size
    if samples <= most:
        return np.arange(samples)
    parts = np.array_split(np.arange(samples), max(most // (2 * len(signals)), 1))
    picked = [own[[x[own].argmin(), x[own].argmax()]] for own in parts for x in signals]
    return np.unique(np.concatenate(picked))


def figure_traces(
    t: FloatArray,
    u: FloatArray,
    y: FloatArray,
    before: FloatArray,
    after: FloatArray,
    measured: np.ndarray | None = None,
) -> dict[str, list[Any]]:
    """Reduce the signals to the samples that preserve the output and both errors in a figure.

    Parameters
    ----------
    t, u, y : ndarray, shape (N,)
    before, after : ndarray, shape (N,)
        Outputs of the simulations.
    measured : ndarray of bool, shape (N,), optional
        Samples with an output; by default all.

    Returns
    -------
    dict of list
        The five signals at the same samples; the output is None where there is none.
    """
    pick = extreme_samples([y, y - before, y - after])
    named = {"t": t, "u": u, "y": y, "before": before, "after": after}
    signals = {name: x[pick].tolist() for name, x in named.items()}
    if measured is None:
        return signals
    return signals | {
        "y": [value if there else None for value, there in zip(signals["y"], measured[pick], strict=True)]
    }


def packed(signal: FloatArray, kind: str = "<f4") -> str:
    """A signal in base64, as numbers of 32 bits (``"<f4"``) or 64 (``"<f8"``)."""
    return base64.b64encode(np.asarray(signal, kind).tobytes()).decode("ascii")


def unpacked(part: dict[str, Any]) -> dict[str, FloatArray]:
    """Signals of a part of the report that is replayed, scaled, with ``counts``: 1 where it is fitted or scored."""
    kinds = {"u": "<f8", "y": "<f4", "before": "<f4", "after": "<f4"}
    trace = {name: np.frombuffer(base64.b64decode(part[name]), kind).astype(float) for name, kind in kinds.items()}
    at = np.arange(trace["u"].size)
    counts = lies_within([*part["fitted"], *part["scored"]], at).astype(float)
    return trace | {"t": part["start"] + part["Ts"] * at, "counts": counts}


def worst_stretch(report: dict[str, Any], name: str) -> dict[str, FloatArray] | None:
    """All samples of the stretch in which the simulation before has the largest error, in the units of the record.

    Parameters
    ----------
    report : dict
    name : str
        "record" or "holdout".

    Returns
    -------
    dict of ndarray or None
        None if the report does not hold all samples.
    """
    if report.get("replay") is None:
        return None
    trace, scale = unpacked(report["replay"][name]), report["replay"]["y_scale"]
    part = _worst(trace)
    return part | {key: scale["centre"] + scale["unit"] * part[key] for key in ("y", "before", "after")}


def _worst(trace: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """The stretch of a trace in which the simulation before has the largest error, where that counts."""
    power = np.nan_to_num(trace["y"] - trace["before"]) ** 2 * trace["counts"]
    length = min(max(int(STRETCH * power.size), FEWEST), MOST, power.size)
    first = int(np.argmax(window_sums(power, length)))
    return {key: signal[first : first + length] for key, signal in trace.items()}


def record_traces(report: dict[str, Any]) -> list[dict[str, FloatArray]]:
    """The traces of each of several records, with times from its own start.

    Parameters
    ----------
    report : dict
        Of several records: its traces are those of the fits that are scored.

    Returns
    -------
    list of dict of ndarray
        In the order of the records; ``counts`` is 1 at the samples that are scored, else 0.
    """
    trace, Ts = {name: np.array(x, float) for name, x in report["traces"].items()}, report["record"]["Ts"]
    found = []
    for row in report["records"]:
        t = trace["t"] - row["start"]
        own = {name: x[(t > -0.5 * Ts) & (t < (row["samples"] - 0.5) * Ts)] for name, x in trace.items()}
        own["t"] = own["t"] - row["start"]
        found.append(own | {"counts": (own["t"] > (row["unscored"] - 0.5) * Ts).astype(float)})
    return found


def worst_of_records(report: dict[str, Any]) -> tuple[str, float, dict[str, FloatArray]]:
    """The stretch of several records in which the simulation before has the largest error: its record and samples.

    Returns
    -------
    str
        Name of the record.
    float
        Its start, in the times of the report.
    dict of ndarray
        Samples of the stretch, with times from the start of the record.
    """
    stretches = [_worst(trace) for trace in record_traces(report)]
    power = [float(np.nansum((one["y"] - one["before"]) ** 2 * one["counts"])) for one in stretches]
    worst = int(np.argmax(power))
    row = report["records"][worst]
    return str(row["name"]), float(row["start"]), stretches[worst]
