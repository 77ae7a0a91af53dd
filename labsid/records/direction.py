"""Which of two signals drives the other, by Granger causality."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from labsid._arrays import FloatArray

LAGS = 8


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
