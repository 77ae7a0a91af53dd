"""Frequency and step response, measured and of the simulations, estimated in one way: from the JSON report alone."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.signal import csd

from labsid._arrays import FloatArray, stretches_of
from labsid.gap.reports.traces import unpacked

FEWEST = 200  # samples in a row, from which there are responses
SEGMENTS = 4  # of the record, for the spectra
OVERLAPPED = 2 * SEGMENTS - 1  # segments of that length, each overlapped by half
NEIGHBOURS = 1.5  # bins of a Hann window that hold the same noise
BANDS = 24  # of frequencies, of equal ratio
LEAST_POWER = 1e-5  # of the input in a band, over its largest
LEAST_COHERENCE = 0.3
DEVIATIONS = 1.96  # for 95 %
BINS = 16  # of lags, of which each has one height of the impulse response
LONGEST = 0.2  # of the record, of the step response
LEAST_EXPLAINED = 0.5  # of the variance of y: a response that does not settle explains less
WORST_CONDITION = 1e4
BLOCKS = 20  # of samples whose errors are independent, for the standard error of the step response


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """A response of y to u at the same points.

    Attributes
    ----------
    x : ndarray, shape (n,)
        Frequencies in hertz, or times after a step in seconds.
    measured, before, after : ndarray, shape (n,)
        Complex gains, or heights in units of y for one unit of u.
    error : ndarray, shape (n,)
        Of the measured one for 95 %: relative of a gain, in units of a height.
    """

    x: FloatArray
    measured: np.ndarray
    before: np.ndarray
    after: np.ndarray
    error: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ResponseCurves:
    """What the figure of the responses shows; None where the record does not determine one.

    Attributes
    ----------
    frequency, step : Response or None
    """

    frequency: Response | None
    step: Response | None


def find_response_curves(report: dict[str, Any]) -> ResponseCurves | None:
    """Responses on the longest part of the record without missing samples; None if it determines neither.

    Parameters
    ----------
    report : dict
        Where the record shows no gap and the holdout does, they are those on the holdout.

    Notes
    -----
    Averages of spectra, and lags of limited length, are biased. The outputs of the simulations are treated like the
    measured one, so that all have the same bias; and an effect that is not linear has the response that it shows at the
    levels of this record.
    """
    replay = report.get("replay")
    if replay is None:
        return None
    part = replay["holdout" if "only_on_holdout" in report else "record"]
    trace, scales = unpacked(part), (replay["y_scale"]["unit"], replay["u_scale"]["unit"])
    outputs = [trace[name] for name in ("y", "before", "after")]
    runs = stretches_of(np.logical_and.reduce(np.isfinite(outputs)))
    start, stop = max(runs, key=lambda run: run[1] - run[0], default=(0, 0))
    if stop - start < FEWEST or np.ptp(trace["u"][start:stop]) == 0.0:
        return None
    u = trace["u"][start:stop]
    signals = np.array([y[start:stop] for y in outputs])
    gain = scales[0] / scales[1]
    found = ResponseCurves(
        _frequency_response(u, signals, part["Ts"], gain), _step_response(u, signals, part["Ts"], gain)
    )
    return None if found.frequency is None and found.step is None else found


def _frequency_response(u: FloatArray, outputs: FloatArray, Ts: float, gain: float) -> Response | None:
    """Cross spectra over the spectrum of the input, averaged over segments and bands."""
    length = u.size // SEGMENTS
    how: dict[str, Any] = {"fs": 1.0 / Ts, "nperseg": length, "detrend": "linear"}
    frequency, power = csd(u, u, **how)
    cross = np.array([csd(u, y, **how)[1] for y in outputs])
    output = csd(outputs[0], outputs[0], **how)[1].real
    edges = np.geomspace(frequency[1], frequency[-1], BANDS + 1)
    band = np.clip(np.searchsorted(edges, frequency[1:], side="right") - 1, 0, BANDS - 1)
    count = np.bincount(band, minlength=BANDS)
    used = count > 0

    def averaged(x: np.ndarray) -> np.ndarray:
        total = np.bincount(band, x[1:].real, BANDS) + 1j * np.bincount(band, x[1:].imag, BANDS)
        return np.asarray(total[used] / count[used])

    suu, syy, centre = averaged(power).real, averaged(output).real, averaged(frequency).real
    suy = np.array([averaged(one) for one in cross])
    coherence = np.abs(suy[0]) ** 2 / np.maximum(suu * syy, 1e-300)
    seen = (suu > LEAST_POWER * suu.max()) & (coherence > LEAST_COHERENCE)
    if seen.sum() < 3:
        return None
    averages = OVERLAPPED * np.maximum(count[used][seen] / NEIGHBOURS, 1.0)
    error = np.sqrt((1.0 / coherence[seen] - 1.0) / (2.0 * averages))
    measured, before, after = (gain * suy / suu)[:, seen]
    return Response(centre[seen], measured, before, after, DEVIATIONS * np.maximum(error, 0.0))


def _step_response(u: FloatArray, outputs: FloatArray, Ts: float, gain: float) -> Response | None:
    """Sums of an impulse response that is constant within bins of lags, by least squares."""
    longest = int(LONGEST * u.size)
    edges = np.unique(np.round(np.geomspace(1.0, longest, BINS))).astype(int)
    edges = np.concatenate([[0], edges])
    sums = np.concatenate([[0.0], np.cumsum(u)])
    at = np.arange(longest, u.size)  # a lag of the bin [a, b) is at least a and less than b
    bins = [sums[at + 1 - a] - sums[at + 1 - b] for a, b in pairwise(edges.tolist())]
    X = np.column_stack([*bins, np.ones(at.size)])
    scale = np.linalg.norm(X, axis=0)
    if scale.min() == 0.0 or np.linalg.cond(X / scale) > WORST_CONDITION:
        return None
    Y = outputs[:, at].T
    inverse = np.linalg.inv((X / scale).T @ (X / scale)) / np.outer(scale, scale)
    heights = inverse @ X.T @ Y
    e = Y[:, 0] - X @ heights[:, 0]
    if np.var(e) > (1.0 - LEAST_EXPLAINED) * np.var(Y[:, 0]):
        return None
    scores = np.array([X[part].T @ e[part] for part in np.array_split(np.arange(at.size), BLOCKS)])
    covariance = inverse @ scores.T @ scores @ inverse
    total = np.tril(np.ones((edges.size - 1, edges.size - 1))) * np.diff(edges)
    measured, before, after = (gain * total @ heights[:-1]).T
    error = np.sqrt(np.einsum("ij,jk,ik->i", total, covariance[:-1, :-1], total))
    return Response(Ts * edges[1:], measured, before, after, DEVIATIONS * abs(gain) * error)
