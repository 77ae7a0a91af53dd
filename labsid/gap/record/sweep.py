"""Whether an input sweeps its frequency once, as a chirp does: its times are then its frequencies."""

import numpy as np

from labsid._arrays import FloatArray

PARTS = 6  # of the record, in which the crossings of the mean are counted; set by hand
MIN_CROSSINGS = 12  # of the whole record: fewer show no frequency; set by hand
MIN_RATIO = 3.0  # of the crossings of its mean in the last part and the first one, or the reverse; set by hand


def sweeps_once(u: FloatArray) -> bool:
    """Whether the frequency of a signal only rises, or only falls, from the first part of a record to the last.

    Parameters
    ----------
    u : ndarray, shape (N,)
    """
    crosses = np.abs(np.diff(np.sign(u - u.mean()))) > 0.0
    counts = np.array([int(part.sum()) for part in np.array_split(crosses, PARTS)])
    if counts.sum() < MIN_CROSSINGS:
        return False
    rising = counts if counts[-1] > counts[0] else counts[::-1]
    return bool(np.all(np.diff(rising) >= 0) and rising[-1] >= MIN_RATIO * max(int(rising[0]), 1))
