"""The signals of a report's figures: all samples of a short record, the extremes of each stretch of a long one."""

import numpy as np

from labsid._arrays import FloatArray

MAX_POINTS = 2400


def extreme_samples(signals: list[FloatArray], most: int = MAX_POINTS) -> np.ndarray:
    """Choose the samples that a thinned-out figure shows: where any of the signals is lowest or highest in its stretch.

    Parameters
    ----------
    signals : list of ndarray, shape (N,)
    most : int
        Samples that a figure shows at most.

    Returns
    -------
    ndarray of int
        In order; all of them where there are no more. So no spike is lost, however long the record.
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
    """Signals for the figures, thinned out so that the output, and what both simulations miss of it, keep their shape.

    Parameters
    ----------
    t, u, y : ndarray, shape (N,)
    before, after : ndarray, shape (N,)
        The simulations.

    Returns
    -------
    dict of list
        All five at the same samples.
    """
    pick = extreme_samples([y, y - before, y - after])
    named = {"t": t, "u": u, "y": y, "before": before, "after": after}
    return {name: x[pick].tolist() for name, x in named.items()}
