"""Location of the gap in time, frequency and operating range, as shares of the baseline's squared error."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from labsid._arrays import FloatArray

SEGMENTS = 12
BANDS = 8
CELLS = 6
MAP_CELLS = 14  # in each direction
MAX_STRETCHES = 60


def share_by_time(t: FloatArray, e: FloatArray, Ts: float, marked: np.ndarray) -> list[list[float]]:
    """Segments [t0, t1, share] that cover the record.

    Parameters
    ----------
    t, e : ndarray, shape (N,)
        Times, and the baseline's error.
    Ts : float
    marked : ndarray of bool, shape (N,)
        Samples on which the effect acts; each stretch of them is a segment. Without any, or with too many, the
        segments have equal length.
    """
    edges = np.flatnonzero(np.diff(marked.astype(int))) + 1
    if not 0 < edges.size <= 2 * MAX_STRETCHES:
        edges = np.linspace(0, e.size, SEGMENTS + 1).astype(int)[1:-1]
    bounds = np.unique(np.concatenate([[0], edges, [e.size]]))
    total = float(e @ e) or 1.0
    return [[float(t[a]), float(t[b - 1] + Ts), float(e[a:b] @ e[a:b]) / total] for a, b in pairwise(bounds)]


def share_by_record(
    segments: Sequence[Sequence[float]], records: Sequence[Mapping[str, Any]], Ts: float
) -> list[dict[str, Any]]:
    """Shares of the gap and of the time in each of several records.

    Parameters
    ----------
    segments : sequence of (float, float, float)
        Of all records one after the other, as `share_by_time` returns them.
    records : sequence of mapping
        With ``name``, ``start`` in seconds and ``samples``.
    Ts : float

    Returns
    -------
    list of dict
        ``name``, ``share`` and ``time``, in the order of the records; the shares add up to 1.
    """
    found = []
    for row in records:
        start, stop = row["start"], row["start"] + row["samples"] * Ts
        share = sum(s * max(min(b, stop) - max(a, start), 0.0) / (b - a) for a, b, s in segments if b > a)
        found.append({"name": str(row["name"]), "share": share, "time": stop - start})
    share, time = (sum(one[key] for one in found) or 1.0 for key in ("share", "time"))
    return [one | {"share": one["share"] / share, "time": one["time"] / time} for one in found]


def share_by_frequency(e: FloatArray, Ts: float) -> list[list[float]]:
    """Octave bands [f0, f1, share] from zero to the Nyquist frequency."""
    power = np.abs(np.fft.rfft(e)) ** 2
    power[1 : (e.size + 1) // 2] *= 2.0  # both halves of the spectrum, all but zero and Nyquist
    nyquist = 0.5 / Ts
    edges = np.concatenate([[0.0], nyquist * 2.0 ** np.arange(-BANDS + 1, 1)])
    f = np.fft.rfftfreq(e.size, Ts)
    band = np.clip(np.searchsorted(edges, f, side="right") - 1, 0, BANDS - 1)
    shares = np.bincount(band, power, BANDS) / (power.sum() or 1.0)
    return [[float(a), float(b), float(s)] for (a, b), s in zip(pairwise(edges), shares, strict=True)]


def share_by_value(name: str, x: FloatArray, e: FloatArray) -> list[dict[str, object]]:
    """Cells over the range of one signal, with their shares of the error and of the samples."""
    edges = np.linspace(float(x.min()), float(x.max()), CELLS + 1)
    cell = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, CELLS - 1)
    shares = np.bincount(cell, e**2, CELLS) / (float(e @ e) or 1.0)
    times = np.bincount(cell, minlength=CELLS) / x.size
    return [
        {
            "signal": name,
            "low": float(edges[i]),
            "high": float(edges[i + 1]),
            "share": float(shares[i]),
            "time": float(times[i]),
        }
        for i in range(CELLS)
    ]


def most_uneven_signal(u: FloatArray, y: FloatArray, Ts: float, e: FloatArray) -> list[dict[str, object]]:
    """Cells of the signal (input, output or its rate) over whose range the error is most uneven."""
    signals = {"u": u, "y": y, "dy": np.gradient(y, Ts)}
    return max((share_by_value(name, x, e) for name, x in signals.items()), key=unevenness)


def unevenness(cells: list[dict[str, object]]) -> float:
    """Total variation distance between the shares of error and time over the cells: 0 to 1."""
    share, time = (np.array([cell[name] for cell in cells], float) for name in ("share", "time"))
    return float(0.5 * np.abs(share - time).sum())


def operating_map(u: FloatArray, y: FloatArray, e: FloatArray) -> dict[str, object]:
    """Rms error in cells of input and output: edges of both, and a row per cell of u; None in cells not visited."""
    count, u_edges, y_edges = np.histogram2d(u, y, MAP_CELLS)
    power = np.histogram2d(u, y, (u_edges, y_edges), weights=e**2)[0]
    rms = [
        [float(np.sqrt(p / n)) if n else None for p, n in zip(*row, strict=True)]
        for row in zip(power, count, strict=True)
    ]
    return {"u": u_edges.tolist(), "y": y_edges.tolist(), "rms": rms}
