"""Which samples of a record are kept from the fits that are scored."""

import numpy as np

BLOCKS = 6
HELD_OUT = 0.32  # of the record
EDGE_MARGIN = 0.02  # of a sixth: an instant at the very edge of a block
LATE = 0.6  # of a sixth: an instant behind it is near the last third
FITTED_START = 0.15  # of the first sixth: without it, nothing would tell in which state the record begins


def held_out_samples(samples: int, onset: float | None = None) -> np.ndarray:
    """Which samples are held out: the middle third, or nearly, of every sixth of the record.

    The end of the record is not among them: what wanders can be followed from one side to the other, not foretold.
    Where something begins there it is the last third instead, or the first: an instant that lies among samples which no
    fit sees cannot be found. The very beginning of the record is always fitted.

    Parameters
    ----------
    samples : int
    onset : float, optional
        As a share of the record.
    """
    place = np.arange(samples) * BLOCKS % samples / samples
    centre, half = 0.5, 0.5 * HELD_OUT
    begun = 0.0 if onset is None else onset * BLOCKS % 1.0
    if abs(begun - centre) < half + EDGE_MARGIN:
        centre = 1.0 - half if begun < LATE else half
    first = np.arange(samples) * BLOCKS < samples
    return np.abs(place - np.where(first, max(centre, half + FITTED_START), centre)) <= half
