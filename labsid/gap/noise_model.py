"""Coloured residuals: an autoregressive model of them, and the whitened score by which hypotheses are compared."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray

MAX_LAGS = 8
MIN_COMPLETE_SHARE = 0.1  # of the rows that count
MIN_SAMPLES = 20  # rows from which noise can be told
MIN_VARIANCE = 1e-26  # variance, the record's being one: what is below is rounding
ORDERS = (0, 1, 2, 3, 4, 6, 8)


@dataclass(frozen=True, slots=True, eq=False)
class Noise:
    """An autoregression of a residual: e(k) = ar[0] e(k-1) + ... + white noise of variance `sigma2`.

    Attributes
    ----------
    ar : ndarray, shape (p,)
    sigma2 : float
        Variance of the innovations.
    score : float
        n log(sigma2) + p log(n): the noise model's part of the BIC.
    rows : int
        n, the samples that it was fitted on.
    """

    ar: FloatArray
    sigma2: float
    score: float
    rows: int


def usable_lags(rows: np.ndarray) -> int:
    """How many lags noise may have: the usual number, fewer where hardly a sample has so many good ones before it."""
    lags = MAX_LAGS
    while lags > 1 and complete_rows(rows, lags).sum() < MIN_COMPLETE_SHARE * rows.sum():
        lags //= 2
    return lags


def complete_rows(rows: np.ndarray, lags: int = MAX_LAGS) -> np.ndarray:
    """Samples that count together with the `lags` samples before them; `rows` says which count at all."""
    sound = rows.copy()
    sound[:lags] = False
    for lag in range(1, lags + 1):
        sound[lag:] &= rows[:-lag]
    return sound


def fit_noise(e: FloatArray, sound: np.ndarray, lags: int = MAX_LAGS) -> Noise:
    """Fit autoregressions of several orders on the rows `sound` and keep the one of the best BIC.

    Parameters
    ----------
    e : ndarray, shape (N,)
        The residual, the held-out samples included (their neighbours need them).
    sound : ndarray of bool, shape (N,)
        From `whole_rows`.
    lags : int
        The longest autoregression.

    Raises
    ------
    ValueError
        If hardly any sample counts together with those before it.
    """
    at = np.flatnonzero(sound)
    if at.size < MIN_SAMPLES:
        raise ValueError(
            f"only {at.size} samples have {lags} good ones before them; at least {MIN_SAMPLES} must. Exclude less; if "
            "the output is read more seldom than it is logged, keep only the fresh readings."
        )
    target = e[at]
    lagged = np.column_stack([e[at - lag] for lag in range(1, lags + 1)])
    n = at.size
    gram, cross, power = lagged.T @ lagged, lagged.T @ target, float(target @ target)
    if power <= MIN_VARIANCE * n:
        return Noise(np.zeros(0), MIN_VARIANCE, n * float(np.log(MIN_VARIANCE)), n)
    best: Noise | None = None
    for order in (order for order in ORDERS if order <= lags):
        ar = np.zeros(0)
        left = power
        if order:
            ridge = 1e-9 * np.trace(gram) / lags * np.eye(order)
            ar = np.linalg.solve(gram[:order, :order] + ridge, cross[:order])
            left = power - float(2.0 * ar @ cross[:order] - ar @ gram[:order, :order] @ ar)
        sigma2 = max(left / n, MIN_VARIANCE)
        score = n * np.log(sigma2) + order * np.log(n)
        if best is None or score < best.score:
            best = Noise(ar, sigma2, float(score), n)
    assert best is not None
    return best
