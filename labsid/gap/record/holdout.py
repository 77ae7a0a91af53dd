"""The samples of a record that are held out for scoring."""

import numpy as np

BLOCKS = 6  # of a record, each with a part that is held out; set by hand
HELD_OUT = 0.32  # of the record; definition: the report promises 0.3 at least
EDGE_MARGIN = 0.02  # of a sixth: an onset this close to a block counts as inside; set by hand
LATE = 0.6  # of a sixth: later onsets move the block to the first third; set by hand
FITTED_START = 0.15  # of the first sixth: always fitted, to estimate the initial state; set by hand


def held_out_samples(samples: int, onset: float | None = None) -> np.ndarray:
    """Mark the held-out samples: about the middle third of every sixth of the record.

    The end of the record is fitted: drifts can be interpolated, not predicted. If an onset falls into the middle
    thirds, the last or first thirds are held out instead: an onset among held-out samples cannot be estimated. The
    start of the record is always fitted.

    Parameters
    ----------
    samples : int
    onset : float, optional
        Instant at which an effect begins, as a share of the record.

    Returns
    -------
    ndarray of bool, shape (samples,)
    """
    place = np.arange(samples) * BLOCKS % samples / samples
    centre, half = 0.5, 0.5 * HELD_OUT
    begun = 0.0 if onset is None else onset * BLOCKS % 1.0
    if abs(begun - centre) < half + EDGE_MARGIN:
        centre = 1.0 - half if begun < LATE else half
    first = np.arange(samples) * BLOCKS < samples
    return np.abs(place - np.where(first, max(centre, half + FITTED_START), centre)) <= half
