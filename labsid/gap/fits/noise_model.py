"""Autoregressive model of coloured residuals, and its contribution to the BIC."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, lagged_columns
from labsid.gap.record.data import MAX_LAGS

MIN_SAMPLES = 20  # rows for a noise model
MIN_VARIANCE = 1e-26  # relative to that of the record: below is rounding
ORDERS = (0, 1, 2, 3, 4, 6, 8)  # of the autoregressive model, of which BIC selects one
SLOWEST_POLE = 1.0 - 1e-6  # of the noise


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
    """

    ar: FloatArray
    sigma2: float
    score: float
    rows: int

    @property
    def correlation_time(self) -> float:
        """Time in samples over which the slowest part of the noise falls to 1/e; 0 of white noise."""
        pole = float(np.abs(np.roots([1.0, *-self.ar])).max(initial=0.0)) if self.ar.size else 0.0
        return float(-1.0 / np.log(min(pole, SLOWEST_POLE))) if pole > 0.0 else 0.0


def fit_noise(e: FloatArray, complete: np.ndarray, lags: int = MAX_LAGS) -> Noise:
    """Fit autoregressive models of several orders on the rows `complete` and select one by BIC.

    Parameters
    ----------
    e : ndarray, shape (N,)
        The residual on all rows.
    complete : ndarray of bool, shape (N,)
        From `complete_rows`.
    lags : int
        The largest order.

    Raises
    ------
    ValueError
        If too few rows are complete.
    """
    at = np.flatnonzero(complete)
    if at.size < MIN_SAMPLES:
        raise ValueError(
            f"only {at.size} samples follow {lags} used samples; at least {MIN_SAMPLES} must. The output "
            "has too few readings of its own, or too many are excluded: record for longer, or exclude fewer."
        )
    target = e[at]
    lagged = lagged_columns(e, at, lags)
    n = at.size
    gram, cross, power = lagged.T @ lagged, lagged.T @ target, float(target @ target)
    if power <= MIN_VARIANCE * n:
        return Noise(np.zeros(0), MIN_VARIANCE, n * float(np.log(MIN_VARIANCE)), n)
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
            best = Noise(ar, sigma2, float(score), n)
    assert best is not None
    return best
