"""Time ranges that are neither fitted nor scored."""

from collections.abc import Sequence

import numpy as np

from labsid._arrays import FloatArray

MIN_SAMPLES = 100  # of a record, and of each of several outputs; set by hand


def included_samples(t: FloatArray, exclude: Sequence[tuple[float, float]]) -> np.ndarray:
    """Mask of the samples outside the excluded time ranges, shape (N,).

    Raises
    ------
    ValueError
        If a range contains no sample.
    """
    rows = np.ones(t.size, bool)
    for start, stop in exclude:
        inside = (t >= start) & (t < stop)
        if not inside.any():
            span = f"{t[0]:g} to {t[-1]:g} s"
            raise ValueError(f"--exclude {start:g}:{stop:g} contains no sample: the record runs from {span}.")
        rows &= ~inside
    return rows
