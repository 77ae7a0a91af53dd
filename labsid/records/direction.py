"""Which of two signals drives the other, by Granger causality."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from labsid._arrays import FloatArray, lagged_columns, left_by

LAGS = 8
NOISE_LAGS = 12  # of both signals, by which the noise of the output is estimated
OWN_LAGS = 20  # of a signal, by which it is predicted without that noise: as far back as the noise knows it
LEAST_NOISE = 1e-6  # of the standard deviation of the output: below it, rounding is taken for noise
DEPENDENT = 1e-9  # singular value of a regressor over the largest, below which it repeats others


def gain_from_past(x: FloatArray, y: FloatArray) -> float:
    """F statistic for Granger causality: does the past of `x` improve the prediction of `y` from its own past?

    Parameters
    ----------
    x, y : ndarray, shape (N,)
        Two signals sampled together.

    Returns
    -------
    float
        About 1 if the past of `x` does not help; 0 if there are too few samples (N < 40).

    Notes
    -----
    Uses eight lags of each signal. Measured from input to output: 37 to 117 on the lab's tanks, 758 on the hair
    dryer, 11 on the cascaded tanks; from output to input: below 3 on all of these, 32 on the lab's closed loop.
    """
    rows = y.size - LAGS
    if rows < 4 * LAGS:
        return 0.0
    own = np.column_stack([sliding_window_view(y, LAGS)[:rows], np.ones(rows)])
    both = np.column_stack([own, sliding_window_view(x, LAGS)[:rows]])
    target = y[LAGS:]
    alone, together = (_squared_error(Phi, target) for Phi in (own, both))
    # Rounding error of a perfect prediction; it keeps the ratio of two perfect predictions finite.
    floor = np.finfo(float).eps * float(np.sum(target**2)) + np.finfo(float).tiny
    return max(alone - together, 0.0) / LAGS / (max(together, floor) / (rows - both.shape[1]))


def feedback_statistic(u: FloatArray, y: FloatArray) -> float:
    """F statistic for feedback: do the past and the noise of the output both help to predict the input?

    Parameters
    ----------
    u, y : ndarray, shape (N,)
        Input and output, sampled together.

    Returns
    -------
    float
        The smaller one of two statistics: of the past of `y`, `gain_from_past`; and of the past of the noise of `y`,
        which is what the past of both signals and the input of the same sample do not foretell of it.

    Notes
    -----
    The first alone is about 20 to 180 for many smooth inputs that nothing feeds back, such as a chirp or a sum of
    sinusoids: their past is in the output, too. The second is below 4 on these. It is 1 in a loop whose controller
    does not see the noise of the record; `gain_from_past` shows such a loop.
    """
    return min(gain_from_past(y, u), _gain_from_noise(u, y))


def _gain_from_noise(u: FloatArray, y: FloatArray) -> float:
    """F statistic of the past of the output's noise for the input; 0 of too short a record, or one without noise."""
    first, rows = OWN_LAGS + LAGS, u.size - OWN_LAGS - LAGS
    if rows < 2 * first:
        return 0.0
    u, noise = u - np.mean(u), np.zeros(y.size)
    at = np.arange(NOISE_LAGS, y.size)
    past = [lagged_columns(y - np.mean(y), at, NOISE_LAGS), lagged_columns(u, at, NOISE_LAGS), u[at, None]]
    noise[at], _ = _left(np.column_stack(past), y[at])
    if np.std(noise[at]) <= LEAST_NOISE * np.std(y):
        return 0.0
    at = np.arange(first, y.size)
    own = lagged_columns(u, at, OWN_LAGS)
    alone, fewer = _left(own, u[at])
    together, more = _left(np.column_stack([own, lagged_columns(noise, at, LAGS)]), u[at])
    if more == fewer:
        return 0.0
    error = max(float(together @ together), np.finfo(float).tiny) / (rows - more)
    return max(float(alone @ alone - together @ together), 0.0) / (more - fewer) / error


def _left(columns: FloatArray, target: FloatArray) -> tuple[FloatArray, int]:
    """What columns and a constant leave of a target, and the number of independent ones."""
    return left_by(np.column_stack([columns, np.ones(target.size)]), target, DEPENDENT)


def look_swapped(u: FloatArray, y: FloatArray) -> bool:
    """Whether `y` is certainly the input of the experiment and `u` its output.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
        The signals labelled as input and output.

    Returns
    -------
    bool
        True only if `y` takes at most ten exact levels and `u` ten times as many, the past of `y` clearly helps
        to predict `u`, and the past of `u` does not help to predict `y`. The last condition spares a coarsely
        quantized output, which its input predicts.
    """
    levels = np.unique(y).size
    if not 2 <= levels <= 10 or np.unique(u).size < 10 * levels:
        return False
    return gain_from_past(y, u) > 30 and gain_from_past(u, y) < 4


def _squared_error(Phi: FloatArray, target: FloatArray) -> float:
    return float(np.sum((target - Phi @ np.linalg.lstsq(Phi, target)[0]) ** 2))
