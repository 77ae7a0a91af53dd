"""How exact the share of the gap is that a candidate closes: an interval from its errors in blocks of the samples."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.verdict.scores import DRAWS, PERCENTILES, RESAMPLED_BLOCKS, resampled_means

LEAST_SAMPLES = 5 * RESAMPLED_BLOCKS  # from which there are blocks of several samples
NEVER = -1.0  # a lower share is not told from others: the simulation with the effect is much worse


def share_interval(before: FloatArray, after: FloatArray, floor: float) -> tuple[float, float] | None:
    """95 % interval of the share of the gap that is closed, from resampled blocks.

    Parameters
    ----------
    before, after : ndarray, shape (n,)
        Errors of the two simulations at the same samples, in order of time.
    floor : float
        Mean square of the noise.

    Returns
    -------
    tuple of float or None
        From -1 to 1; None for few samples, or where the errors before are noise in some of the drawn blocks.

    Notes
    -----
    The share is 1 - sqrt((m1 - floor)/(m0 - floor)) with mean squares m0 and m1. The same blocks are drawn for both.
    """
    if before.size < LEAST_SAMPLES:
        return None
    means = np.array([[np.mean(block**2) for block in np.array_split(e, RESAMPLED_BLOCKS)] for e in (before, after)])
    if not np.isfinite(means).all():
        return None
    drawn = np.random.default_rng(0).integers(0, RESAMPLED_BLOCKS, (DRAWS, RESAMPLED_BLOCKS))
    m0, m1 = resampled_means(means, drawn)
    if np.any(m0 <= floor):
        return None
    shares = 1.0 - np.sqrt(np.maximum(m1 - floor, 0.0) / (m0 - floor))
    low, high = np.percentile(np.maximum(shares, NEVER), PERCENTILES)
    return float(low), float(high)
