"""Autoregressive model of coloured residuals, and its contribution to the BIC."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, lagged_columns
from labsid.gap.record.data import MAX_LAGS, MIN_COMPLETE, Data

MIN_VARIANCE = 1e-26  # relative to that of the record: below is rounding; numerics
ORDERS = (0, 1, 2, 3, 4, 6, 8)  # of the autoregressive model, of which BIC selects one; set by hand
SLOWEST_POLE = 1.0 - 1e-6  # of the noise; numerics


@dataclass(frozen=True, slots=True, eq=False)
class Noise:
    """Autoregressive model of a residual: e(k) = ar[0] e(k-1) + ... + white noise of variance `sigma2`.

    Attributes
    ----------
    ar : ndarray, shape (p,)
    sigma2 : float
        Variance of the innovations.
    score : float
        n log(sigma2) + p log(n), the contribution to the BIC.
    rows : int
        n, the number of samples of the fit.
    stride : int
        Samples from one reading to the next: the other elements of `ar` are zero.
    """

    ar: FloatArray
    sigma2: float
    score: float
    rows: int
    stride: int = 1

    @property
    def pole(self) -> float:
        """Modulus of the slowest pole, per sample; 0 of white noise."""
        by_reading = -self.ar[self.stride - 1 :: self.stride]
        return float(np.abs(np.roots([1.0, *by_reading])).max(initial=0.0)) ** (1.0 / self.stride)

    @property
    def correlation_time(self) -> float:
        """Time in samples over which the slowest part of the noise falls to 1/e; 0 of white noise."""
        pole = self.pole
        return float(-1.0 / np.log(min(pole, SLOWEST_POLE))) if pole > 0.0 else 0.0


def noise_of(data: Data, e: FloatArray) -> Noise:
    """The noise of a residual of a record, at the readings that count."""
    return fit_noise(e, data.complete, data.lags, data.stride)


def fit_noise(e: FloatArray, complete: np.ndarray, lags: int = MAX_LAGS, stride: int = 1) -> Noise:
    """Fit autoregressive models of several orders on the rows `complete` and select one by BIC.

    Parameters
    ----------
    e : ndarray, shape (N,)
        The residual on all rows.
    complete : ndarray of bool, shape (N,)
        From `complete_rows`.
    lags : int
        The largest order, in readings.
    stride : int
        Samples from one reading to the next.

    Raises
    ------
    ValueError
        If too few rows are complete.
    """
    at = np.flatnonzero(complete)
    if at.size < MIN_COMPLETE:
        which = f"follow {lags} used samples" if lags else "count"
        raise ValueError(
            f"only {at.size} samples {which}; at least {MIN_COMPLETE} must. The output has too few readings of its "
            "own, or too many are excluded: record for longer, or exclude fewer."
        )
    target = e[at]
    lagged = lagged_columns(e, at, lags, stride)
    n = at.size
    gram, cross, power = lagged.T @ lagged, lagged.T @ target, float(target @ target)
    if power <= MIN_VARIANCE * n:
        return Noise(np.zeros(0), MIN_VARIANCE, n * float(np.log(MIN_VARIANCE)), n, stride)
    best: Noise | None = None
    for order in (order for order in ORDERS if order <= lags):
        ar = np.zeros(0)
        remaining = power
        if order:
            ridge = 1e-9 * np.trace(gram) / lags * np.eye(order)
            ar = np.linalg.solve(gram[:order, :order] + ridge, cross[:order])
            remaining = power - float(2.0 * ar @ cross[:order] - ar @ gram[:order, :order] @ ar)
        sigma2 = max(remaining / n, MIN_VARIANCE)
        score = n * np.log(sigma2) + order * np.log(n)
        if best is None or score < best.score:
            best = Noise(np.kron(ar, np.eye(stride)[-1]), sigma2, float(score), n, stride)
    assert best is not None
    return best
