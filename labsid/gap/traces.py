"""Signals for the figures of a report: all samples of a short record, local extremes of a long one."""

import numpy as np

from labsid._arrays import FloatArray

MAX_POINTS = 2400


def extreme_samples(signals: list[FloatArray], most: int = MAX_POINTS) -> np.ndarray:
    """Select the samples at which any of the signals has its minimum or maximum within a stretch.

    Parameters
    ----------
    signals : list of ndarray, shape (N,)
    most : int
        Largest number of samples.

    Returns
    -------
    ndarray of int
        In order; all samples if there are at most `most`. Spikes are kept, however long the record.
    """
    samples = signals[0].size
    if samples <= most:
        return np.arange(samples)
    stretches = np.array_split(np.arange(samples), max(most // (2 * len(signals)), 1))
    picked = [own[[x[own].argmin(), x[own].argmax()]] for own in stretches for x in signals]
    return np.unique(np.concatenate(picked))


def figure_traces(
    t: FloatArray, u: FloatArray, y: FloatArray, before: FloatArray, after: FloatArray
) -> dict[str, list[float]]:
    """Signals for the figures, thinned so that the output and the errors of both simulations keep their shape.

    Parameters
    ----------
    t, u, y : ndarray, shape (N,)
    before, after : ndarray, shape (N,)
        Simulated outputs.

    Returns
    -------
    dict of list
        The five signals at the same samples.
    """
    pick = extreme_samples([y, y - before, y - after])
    named = {"t": t, "u": u, "y": y, "before": before, "after": after}
    return {name: x[pick].tolist() for name, x in named.items()}
