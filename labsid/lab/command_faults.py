"""Faults of the command that a record shows without a model: a coarse log, or a rig that does not get the command."""

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from labsid._arrays import FloatArray, stretches_of
from labsid.records.signal_quality import lattice_step, runs, scatter

MAX_STEPS = 500  # of the log in the range of the input, from which its rounding does not matter
WINDOW = 0.04  # of the record, over which the output stands still
STILL = 8.0  # standard deviations of the noise: range of an output that stands still
MIN_LENGTH = 0.08  # of the record
MIN_MOTION = 0.7  # standard deviation of the input meanwhile over that elsewhere
MIN_CHANGES = 3  # of the input meanwhile
MAX_LENGTH = 0.75  # of the record
MAX_THERE = 0.15  # share of the other samples at the same reading: more of them are those of a limit
EDGE = 0.05  # of the range of y: nearer to an end of it the output is held by a limit


def log_step(u: FloatArray) -> float | None:
    """Step in which the input is logged, if it is coarse; None if its rounding does not matter.

    Parameters
    ----------
    u : ndarray, shape (N,)
    """
    step = lattice_step(u)
    return step if step is not None and np.ptp(u) < MAX_STEPS * step else None


def unanswered_command(u: FloatArray, y: FloatArray) -> tuple[int, int] | None:
    """The longest stretch in which the output stands still while the input moves as elsewhere; None if there is none.

    Parameters
    ----------
    u, y : ndarray, shape (N,)

    Returns
    -------
    tuple of (int, int) or None
        The first sample and the one after the last.
    """
    noise, length = scatter(y), max(int(WINDOW * y.size), 5)
    if not noise:
        return None
    motion = maximum_filter1d(y, length) - minimum_filter1d(y, length)
    still = sorted(stretches_of(motion < STILL * noise), key=lambda ends: ends[0] - ends[1])
    for start, stop in still:
        if stop - start < MIN_LENGTH * y.size:
            break
        if stop - start > MAX_LENGTH * y.size:
            continue
        within = slice(start, stop)
        elsewhere = np.concatenate([u[:start], u[stop:]])
        level = float(np.mean(y[within]))
        others = np.concatenate([y[:start], y[stop:]])
        there = float(np.mean(np.abs(others - level) < 0.5 * STILL * noise))
        moves = runs(u[within])[0].size - 1 >= MIN_CHANGES and np.std(u[within]) > MIN_MOTION * np.std(elsewhere)
        if moves and there < MAX_THERE and EDGE < (level - y.min()) / np.ptp(y) < 1.0 - EDGE:
            return start, stop
    return None
