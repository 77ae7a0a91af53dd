"""Frequency and step response, measured and of the simulations, estimated in one way: from the JSON report alone."""

from collections.abc import Sequence
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


def find_response_curves(report: dict[str, Any], further: Sequence[FloatArray] = ()) -> list[ResponseCurves | None]:
    """Responses to each input on the longest part of the record without missing samples; None of one that has neither.

    Parameters
    ----------
    report : dict
        Where the record shows no gap and the holdout does, they are those on the holdout.
    further : sequence of ndarray, shape (N,)
        Other inputs than that of the report. All responses are estimated together.

    Returns
    -------
    list of ResponseCurves or None
        First for the input of the report.

    Notes
    -----
    Averages of spectra, and lags of limited length, are biased. The outputs of the simulations are treated like the
    measured one, so that all have the same bias; and an effect that is not linear has the response that it shows at the
    levels of this record.
    """
    found: list[ResponseCurves | None] = [None] * (1 + len(further))
    replay = report.get("replay")
    if replay is None:
        return found
    part = replay["holdout" if "only_on_holdout" in report else "record"]
    trace, scales = unpacked(part), (replay["y_scale"]["unit"], replay["u_scale"]["unit"])
    outputs = [trace[name] for name in ("y", "before", "after")]
    runs = stretches_of(np.logical_and.reduce(np.isfinite(outputs)))
    start, stop = max(runs, key=lambda run: run[1] - run[0], default=(0, 0))
    inputs = [trace["u"][start:stop], *(u[start:stop] - u[start:stop].mean() for u in further)]
    moving = [i for i, u in enumerate(inputs) if stop > start and np.ptp(u) > 0.0]
    if stop - start < FEWEST or not moving:
        return found
    u, signals = np.array([inputs[i] for i in moving]), np.array([y[start:stop] for y in outputs])
    gains = scales[0] / np.array([scales[1], *[1.0] * len(further)])[moving]
    pairs = zip(
        _frequency_responses(u, signals, part["Ts"], gains), _step_responses(u, signals, part["Ts"], gains), strict=True
    )
    for i, (frequency, step) in zip(moving, pairs, strict=True):
        found[i] = None if frequency is None and step is None else ResponseCurves(frequency, step)
    return found


def _frequency_responses(u: FloatArray, outputs: FloatArray, Ts: float, gains: FloatArray) -> list[Response | None]:
    """Cross spectra divided by the spectra of the inputs, averaged over segments and bands.

    In each band, with S the spectra of the inputs (nu, nu) and c those of inputs and output (nu,), the gains are
    inv(S) c, and the part of the output without them has the power syy - c' inv(S) c.
    """
    length = u.shape[1] // SEGMENTS
    how: dict[str, Any] = {"fs": 1.0 / Ts, "nperseg": length, "detrend": "linear"}
    frequency = csd(u[0], u[0], **how)[0]
    edges = np.geomspace(frequency[1], frequency[-1], BANDS + 1)
    band = np.clip(np.searchsorted(edges, frequency[1:], side="right") - 1, 0, BANDS - 1)
    count = np.bincount(band, minlength=BANDS)
    used = count > 0

    def averaged(x: np.ndarray) -> np.ndarray:
        total = np.bincount(band, x[1:].real, BANDS) + 1j * np.bincount(band, x[1:].imag, BANDS)
        return np.asarray(total[used] / count[used])

    S = np.array([[averaged(csd(a, b, **how)[1]) for b in u] for a in u]).transpose(2, 0, 1)
    c = np.array([[averaged(csd(a, y, **how)[1]) for y in outputs] for a in u]).transpose(2, 0, 1)
    syy, centre = averaged(csd(outputs[0], outputs[0], **how)[1]).real, averaged(frequency).real
    size = np.sqrt(np.maximum(np.einsum("kii->ki", S).real, 1e-300))
    scaled = S / size[:, :, None] / size[:, None, :]
    distinct = np.linalg.cond(scaled) < WORST_CONDITION
    inverse = np.linalg.inv(np.where(distinct[:, None, None], scaled, np.eye(len(u))))
    H = inverse @ (c / size[:, :, None]) / size[:, :, None]
    rest = np.maximum(syy - np.einsum("ki,ki->k", c[:, :, 0].conj(), H[:, :, 0]).real, 0.0)
    found: list[Response | None] = []
    for i, gain in enumerate(gains):
        power = size[:, i] ** 2 / np.einsum("kii->ki", inverse).real[:, i]  # of the input beside the others
        own, noise = np.abs(H[:, i, 0]) ** 2, rest / np.maximum(power, 1e-300)
        coherence = own / np.maximum(own + noise, 1e-300)
        seen = distinct & (power > LEAST_POWER * power.max()) & (coherence > LEAST_COHERENCE)
        if seen.sum() < 3:
            found.append(None)
            continue
        averages = OVERLAPPED * np.maximum(count[used][seen] / NEIGHBOURS, 1.0) - (len(u) - 1)
        error = np.sqrt((1.0 / coherence[seen] - 1.0) / (2.0 * np.maximum(averages, 1.0)))
        measured, before, after = (gain * H[seen, i]).T
        found.append(Response(centre[seen], measured, before, after, DEVIATIONS * np.maximum(error, 0.0)))
    return found


def _step_responses(u: FloatArray, outputs: FloatArray, Ts: float, gains: FloatArray) -> list[Response | None]:
    """Sums of impulse responses that are constant within bins of lags, by least squares."""
    longest = int(LONGEST * u.shape[1])
    edges = np.unique(np.round(np.geomspace(1.0, longest, BINS))).astype(int)
    edges = np.concatenate([[0], edges])
    at = np.arange(longest, u.shape[1])  # a lag of the bin [a, b) is at least a and less than b
    sums = np.pad(np.cumsum(u, axis=1), ((0, 0), (1, 0)))
    bins = [own[at + 1 - a] - own[at + 1 - b] for own in sums for a, b in pairwise(edges.tolist())]
    X = np.column_stack([*bins, np.ones(at.size)])
    scale = np.linalg.norm(X, axis=0)
    if scale.min() == 0.0 or at.size < 2 * scale.size or np.linalg.cond(X / scale) > WORST_CONDITION:
        return [None] * len(u)
    Y = outputs[:, at].T
    inverse = np.linalg.inv((X / scale).T @ (X / scale)) / np.outer(scale, scale)
    heights = inverse @ X.T @ Y
    e = Y[:, 0] - X @ heights[:, 0]
    if np.var(e) > (1.0 - LEAST_EXPLAINED) * np.var(Y[:, 0]):
        return [None] * len(u)
    scores = np.array([X[part].T @ e[part] for part in np.array_split(np.arange(at.size), BLOCKS)])
    covariance = inverse @ scores.T @ scores @ inverse
    width = edges.size - 1
    total = np.tril(np.ones((width, width))) * np.diff(edges)
    found: list[Response | None] = []
    for i, gain in enumerate(gains):
        own = slice(i * width, (i + 1) * width)
        measured, before, after = (gain * total @ heights[own]).T
        error = np.sqrt(np.einsum("ij,jk,ik->i", total, covariance[own, own], total))
        found.append(Response(Ts * edges[1:], measured, before, after, DEVIATIONS * abs(gain) * error))
    return found
