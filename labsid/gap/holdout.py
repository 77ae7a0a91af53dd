"""Which samples of a record are kept from the fits that are scored."""

import numpy as np

BLOCKS = 6
HELD_OUT = 0.32  # of the record


def held_out(samples: int) -> np.ndarray:
    """Which samples are held out: the last third, or nearly, of every sixth of the record."""
    place = np.arange(samples) * BLOCKS % samples / samples
    return place >= 1.0 - HELD_OUT
